package org.fieldwalk.survey

import android.content.Context
import android.content.Intent
import java.io.File
import java.util.concurrent.Executor
import java.util.concurrent.Executors

/**
 * The surveys on disk, side by side, each in a folder that no other ever has; and the one that is on: it outlives screens
 * that turn, and is read from disk after the end of the app.
 */
object CurrentSurvey {
    private var walks: SurveyWalks? = null

    /** Runs what takes seconds; a test may give its own. */
    var background: Executor = Executors.newSingleThreadExecutor { task ->
        Thread(task, "fieldwalk-build").apply { isDaemon = true }
    }

    /** All surveys, the newest first. */
    fun all(context: Context): List<SurveyFolder> = root(context).listFiles().orEmpty().map { SurveyFolder(it) }
        .filter { it.isSurvey }.sortedByDescending { it.name.toLongOrNull() }

    /** The survey of that name; null when there is none. */
    fun folder(context: Context, name: String?): SurveyFolder? = all(context).firstOrNull { it.name == name }

    /** The survey of that name with its walks; null when there is none. Another that was on is left as if ended. */
    fun of(context: Context, name: String?): SurveyWalks? {
        walks?.let { if (it.name == name) return it }
        val folder = folder(context, name) ?: return null
        leave()
        return SurveyWalks(context.applicationContext, folder, background).also { walks = it }
    }

    /** Makes a new survey beside the others. */
    fun create(context: Context, plan: ByteArray, floor: String, ordinal: Int): SurveyFolder {
        var atMs = System.currentTimeMillis()
        while (File(root(context), "$atMs").exists()) atMs += 1
        return SurveyFolder(File(root(context), "$atMs")).also { it.create(plan, floor, ordinal) }
    }

    /** Deletes a survey with all its walks. */
    fun delete(folder: SurveyFolder) {
        if (walks?.name == folder.name) forget()
        folder.folder.deleteRecursively()
    }

    /** As the end of the app: what is not on disk is gone. */
    fun forget() {
        walks?.abandon()
        walks = null
    }

    private fun leave() {
        walks?.endWalk()
        forget()
    }

    /** By the time at which each began: a build that ends late finds its own folder, or none. */
    private fun root(context: Context) = File(context.filesDir, "surveys")
}

/** For which survey a screen is. */
internal const val SURVEY = "survey"

internal fun Intent.of(survey: String): Intent = putExtra(SURVEY, survey)
