package org.fieldwalk.survey

import android.content.Context
import java.io.File
import java.util.concurrent.Executor
import java.util.concurrent.Executors

/** The survey that is on: it outlives screens that turn, and is read from disk after the end of the app. */
object CurrentSurvey {
    private var walks: SurveyWalks? = null

    /** Runs what takes seconds; a test may give its own. */
    var background: Executor = Executors.newSingleThreadExecutor { task ->
        Thread(task, "fieldwalk-build").apply { isDaemon = true }
    }

    fun folder(context: Context) = SurveyFolder(File(context.filesDir, "survey"))

    /** The survey that is on, or that on disk; null when there is none. */
    fun of(context: Context): SurveyWalks? {
        walks?.let { return it }
        val folder = folder(context)
        if (!folder.isSurvey) return null
        return SurveyWalks(context.applicationContext, folder, background).also { walks = it }
    }

    /** Begins a new survey, which drops the one on disk. */
    fun begin(context: Context, plan: ByteArray, floor: String) {
        forget()
        folder(context).create(plan, floor, ordinal = 0)
    }

    /** As the end of the app: what is not on disk is gone. */
    fun forget() {
        walks?.abandon()
        walks = null
    }
}
