package org.fieldwalk.survey

import android.app.Activity
import android.content.Intent
import android.os.Bundle
import android.os.Handler
import android.os.Looper
import android.view.View
import android.view.WindowManager
import android.widget.Button
import android.widget.LinearLayout
import android.widget.TextView
import kotlinx.coroutines.MainScope
import kotlinx.coroutines.cancel
import kotlinx.coroutines.launch

/** The plan with what is covered, and the buttons of the walk. */
class SurveyActivity : Activity() {
    private val scope = MainScope()
    private val looks = Handler(Looper.getMainLooper())
    private lateinit var texts: Texts
    private lateinit var plan: PlanView
    private lateinit var walks: SurveyWalks
    private val buttons = mutableMapOf<Int, Button>()

    override fun onCreate(saved: Bundle?) {
        setTheme(android.R.style.Theme_DeviceDefault_DayNight)
        super.onCreate(saved)
        walks = CurrentSurvey.of(this, intent.getStringExtra(SURVEY)) ?: return finish()
        texts = texts()
        title = walks.floor
        // A screen that locks stops the sensors in the middle of a walk.
        window.addFlags(WindowManager.LayoutParams.FLAG_KEEP_SCREEN_ON)
        plan = PlanView(this, walks.drawing) { walks.tap(it) }.apply {
            id = SurveyIds.PLAN
            contentDescription = texts.planDescription
            tag = 1f
        }
        setContentView(
            screen(
                label(SurveyIds.SUMMARY, 18f),
                plan,
                label(SurveyIds.ADVICE, 18f),
                label(SurveyIds.ACCURACY, 14f),
                label(SurveyIds.MESSAGE, 16f, isUrgent = true),
                row(
                    SurveyIds.BEGIN to texts.beginWalk, SurveyIds.END to texts.endWalk, SurveyIds.PAUSE to texts.pause,
                    SurveyIds.RESUME to texts.resume, SurveyIds.UNDO_TAP to texts.undoTap,
                ),
                row(
                    SurveyIds.UNDO_WALK to texts.undoWalk, SurveyIds.BUILD to texts.buildMap,
                    SurveyIds.CHECK to texts.checkWalk, SurveyIds.SHARE to texts.share,
                ),
            ),
        )
        scope.launch { walks.state.collect(::show) }
    }

    override fun onResume() {
        super.onResume()
        if (::walks.isInitialized) look()
    }

    override fun onPause() {
        looks.removeCallbacksAndMessages(null)
        super.onPause()
    }

    override fun onDestroy() {
        scope.cancel()
        super.onDestroy()
    }

    private fun look() {
        walks.look()
        looks.postDelayed(::look, LOOK_MS)
    }

    private fun row(vararg named: Pair<Int, String>): View = box(
        LinearLayout.HORIZONTAL,
        *named.map { (id, label) -> button(id, label) { press(id) }.also { buttons[id] = it } }.toTypedArray(),
    )

    private fun press(id: Int) = when (id) {
        SurveyIds.BEGIN -> walks.beginWalk()
        SurveyIds.END -> walks.endWalk()
        SurveyIds.PAUSE -> walks.pause()
        SurveyIds.RESUME -> walks.resume()
        SurveyIds.UNDO_TAP -> walks.undoTap()
        SurveyIds.UNDO_WALK -> walks.undoWalk()
        SurveyIds.BUILD -> walks.build()
        SurveyIds.CHECK -> startActivity(Intent(this, CheckActivity::class.java).of(walks.name))
        else -> share()
    }

    private fun share() {
        val folder = CurrentSurvey.folder(this, walks.name) ?: return
        if (walks.readyToShare()) startActivity(ExportProvider.share(this, folder))
    }

    private fun show(state: SurveyState) {
        plan.show(state)
        text(SurveyIds.SUMMARY, texts.summary(state))
        text(SurveyIds.ADVICE, if (state.canEnd) "${texts.advice(state)} (${texts.steps(state.nSteps)})" else texts.advice(state))
        text(SurveyIds.ACCURACY, state.accuracy?.let { texts.accuracy(it.medianM, it.p90M) }.orEmpty())
        val mishap = state.mishap?.let { texts.remedies.say(it) }
        text(SurveyIds.MESSAGE, (state.warnings.sorted().map(texts::warning) + listOfNotNull(mishap)).joinToString("\n"))
        val shown = mapOf(
            SurveyIds.BEGIN to state.canBegin, SurveyIds.END to state.canEnd, SurveyIds.PAUSE to state.canPause,
            SurveyIds.RESUME to state.canResume, SurveyIds.UNDO_TAP to state.canEnd,
        )
        shown.forEach { (id, isShown) -> buttons.getValue(id).visibility = if (isShown) View.VISIBLE else View.GONE }
        val enabled = mapOf(
            SurveyIds.UNDO_TAP to state.canUndoTap, SurveyIds.UNDO_WALK to state.canUndoWalk,
            SurveyIds.BUILD to state.canBuild, SurveyIds.CHECK to (state.hasMap && state.canBegin),
            SurveyIds.SHARE to state.canShare,
        )
        enabled.forEach { (id, isEnabled) -> buttons.getValue(id).isEnabled = isEnabled }
    }

    private fun text(id: Int, text: String) {
        val view = requireViewById<TextView>(id)
        if (view.text.toString() != text) view.text = text
        view.visibility = if (text.isEmpty()) View.GONE else View.VISIBLE
    }

    private companion object {
        const val LOOK_MS = 500L
    }
}
