package org.fieldwalk.survey

import android.app.Activity
import android.os.Bundle
import android.widget.TextView
import kotlinx.coroutines.CancellationException
import kotlinx.coroutines.Job
import kotlinx.coroutines.MainScope
import kotlinx.coroutines.cancel
import kotlinx.coroutines.launch
import org.fieldwalk.ApiException
import org.fieldwalk.BuildingMap
import org.fieldwalk.Fix
import org.fieldwalk.FixMode
import org.fieldwalk.Point2
import org.fieldwalk.PositionHint
import org.fieldwalk.android.Fieldwalk
import org.fieldwalk.android.PositioningSession
import org.fieldwalk.android.SensorClock
import java.io.IOException

/** The map tried: where it puts the surveyor, and how sure it is. */
class CheckActivity : Activity() {
    private val scope = MainScope()
    private var session: PositioningSession? = null
    private var collecting: Job? = null
    private var floor = 0
    private lateinit var plan: PlanView
    private lateinit var texts: Texts
    private lateinit var advice: TextView
    private lateinit var message: TextView

    override fun onCreate(saved: Bundle?) {
        setTheme(android.R.style.Theme_DeviceDefault_DayNight)
        super.onCreate(saved)
        texts = texts()
        title = texts.checkWalk
        advice = label(SurveyIds.ADVICE, 18f, isUrgent = true).apply { text = texts.tapYourPlace }
        message = label(SurveyIds.MESSAGE, 16f, isUrgent = true)
        try {
            val survey = CurrentSurvey.folder(this, intent.getStringExtra(SURVEY)) ?: return finish()
            val file = survey.mapFile.readBytes()
            BuildingMap.fromFile(file.toDirect()).use { map ->
                floor = map.floors().first().ordinal
                plan = PlanView(this, map.drawing(floor), ::hint).apply {
                    id = SurveyIds.PLAN
                    contentDescription = texts.planDescription
                    tag = 1f
                }
                session = Fieldwalk.positioner(this, map, floor)
            }
        } catch (unreadable: ApiException) {
            message.text = texts.remedies.say(unreadable)
            return setContentView(screen(message))
        } catch (_: IOException) {
            return finish()
        }
        setContentView(screen(plan, advice, message))
    }

    override fun onStart() {
        super.onStart()
        val session = session ?: return
        collecting = scope.launch {
            launch { session.status.collect { status -> message.text = status.troubles.firstOrNull()?.let { texts.remedies.say(it) }.orEmpty() } }
            try {
                session.fixes().collect(::show)
            } catch (ended: CancellationException) {
                throw ended
            } catch (broken: ApiException) {
                message.text = texts.remedies.say(broken)
            }
        }
    }

    override fun onStop() {
        collecting?.cancel()
        super.onStop()
    }

    override fun onDestroy() {
        scope.cancel()
        session?.close()
        super.onDestroy()
    }

    private fun hint(point: Point2) {
        val session = session ?: return
        try {
            session.hint(PositionHint(point, HINT_RADIUS_M, floor, SensorClock.nowNs()))
            show(session.fix())
        } catch (refused: ApiException) {
            message.text = texts.remedies.say(refused)
        }
    }

    private fun show(fix: Fix?) {
        plan.show(fix)
        advice.text = if (fix == null) texts.noFixYet else texts.fix(fix.radius68M, fix.mode == FixMode.STALE)
    }

    private companion object {
        /** A finger on a plan, and where one believes to stand. */
        const val HINT_RADIUS_M = 2.0
    }
}
