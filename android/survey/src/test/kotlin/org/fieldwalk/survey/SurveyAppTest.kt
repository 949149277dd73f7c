package org.fieldwalk.survey

import android.content.Intent
import android.net.Uri
import android.view.View
import android.widget.Button
import org.fieldwalk.BuildingMap
import org.fieldwalk.Fix
import org.fieldwalk.Point2
import org.fieldwalk.PositionHint
import org.fieldwalk.Positioner
import org.fieldwalk.SampleBatch
import org.fieldwalk.WalkRefusal
import org.fieldwalk.android.SensorClock
import org.junit.Assert.assertEquals
import org.junit.Assert.assertFalse
import org.junit.Assert.assertNotNull
import org.junit.Assert.assertTrue
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.Robolectric
import org.robolectric.RobolectricTestRunner
import org.robolectric.RuntimeEnvironment
import org.robolectric.Shadows.shadowOf
import org.robolectric.android.controller.ActivityController
import org.robolectric.annotation.Config
import org.robolectric.annotation.GraphicsMode
import java.io.File
import kotlin.math.hypot

/** The app driven by its own views, on a phone whose sensors replay a simulated survey. */
@RunWith(RobolectricTestRunner::class)
@Config(qualifiers = "w411dp-h891dp-420dpi")
@GraphicsMode(GraphicsMode.Mode.NATIVE)
class SurveyAppTest : DrivenApp() {
    @Test
    fun `a survey through the views gives a map as good as the host's`() {
        val survey = openPlan()
        for (recording in RecordedFloor.surveyWalks) {
            survey.press(SurveyIds.BEGIN)
            walk(survey, recording)
            if (recording == RecordedFloor.surveyWalks[1]) shoot(survey.get(), "walking")
            survey.press(SurveyIds.END)
        }
        survey.press(SurveyIds.BUILD)
        runLater()
        val state = walks().state.value
        assertEquals(RecordedFloor.surveyWalks.size, state.nWalks)
        assertEquals(null, state.mishap)
        assertEquals(100, state.coveredPercent)
        val accuracy = state.accuracy!!
        println(
            "expected error, app: median ${accuracy.medianM} m, 80 % ${accuracy.p80M} m; host: median " +
                "${RecordedFloor.expectedMedianM} m, 80 % ${RecordedFloor.expectedP80M} m",
        )
        assertEquals(RecordedFloor.expectedMedianM, accuracy.medianM, 0.1 * RecordedFloor.expectedMedianM)
        assertEquals(RecordedFloor.expectedP80M, accuracy.p80M, 0.1 * RecordedFloor.expectedP80M)
        assertTrue(survey.text(SurveyIds.ACCURACY).contains("Expected error"))
        shoot(survey.get(), "surveyed")

        val map = folder().mapFile
        val own = BuildingMap.fromFile(map.readBytes().toDirect()).use { meanErrorM(it) }
        val host = BuildingMap.open(RecordedFloor.hostMap.path).use { meanErrorM(it) }
        println("mean error of an unseen walk at its waypoints: $own m on the app's map, $host m on the host's")
        assertTrue("$own m, on the host's map $host m", own < 1.1 * host + 0.1)

        shared(survey, map)
        check(survey)
    }

    @Test
    fun `the end of the app in mid-walk loses a second at most`() {
        val survey = openPlan()
        val (first, second) = RecordedFloor.surveyWalks
        survey.press(SurveyIds.BEGIN)
        walk(survey, first)
        survey.press(SurveyIds.END)
        val whole = walks().state.value
        survey.press(SurveyIds.BEGIN)
        walk(survey, second, nWaypoints = 4)
        val (taps, coverage) = walks().state.value.let { it.taps to it.coverage!!.totals }
        assertEquals(4, taps.size)
        // The process is gone; nothing was saved on its way out.
        CurrentSurvey.forget()

        val again = open(SurveyActivity::class.java)
        val state = walks().state.value
        assertEquals(null, state.mishap)
        assertEquals(whole.walkLengthsM[0], state.walkLengthsM[0], 1e-9)
        assertEquals("the cut walk counts up to its last waypoint", 2, state.nWalks)
        assertEquals(coverage.coveredM2, state.coverage!!.totals.coveredM2, 1e-9)
        assertTrue(again.text(SurveyIds.SUMMARY).startsWith("2 walks"))
        // And the survey goes on.
        again.press(SurveyIds.BEGIN)
        walk(again, second, nWaypoints = 3)
        again.press(SurveyIds.END)
        assertEquals(3, walks().state.value.nWalks)
        again.press(SurveyIds.UNDO_WALK)
        assertEquals(2, folder().recordings().size)
    }

    @Test
    fun `what was undone and paused stays so after the end of the app`() {
        val survey = openPlan()
        survey.press(SurveyIds.BEGIN)
        val recording = RecordedFloor.surveyWalks.first()
        walk(survey, recording, nWaypoints = 3)
        survey.press(SurveyIds.UNDO_TAP)
        assertEquals(2, walks().state.value.taps.size)
        survey.press(SurveyIds.PAUSE)
        assertEquals(Phase.PAUSED, walks().state.value.phase)
        assertEquals(View.VISIBLE, survey.view<Button>(SurveyIds.RESUME).visibility)
        survey.press(SurveyIds.RESUME)
        walk(survey, recording, nWaypoints = 2)
        val covered = walks().state.value.coverage!!.totals
        CurrentSurvey.forget()
        val restored = walks().state.value
        assertEquals(covered.routeM, restored.coverage!!.totals.routeM, 1e-9)
    }

    @Test
    @Config(qualifiers = "de-w411dp-h891dp-night-420dpi")
    fun `a turn of the screen keeps the walk, in German and by night`() {
        val start = open(StartActivity::class.java)
        assertEquals(German.choosePlan, start.view<Button>(SurveyIds.CHOOSE_PLAN).text)
        shoot(start.get(), "start-german-night")
        val survey = openPlan()
        survey.press(SurveyIds.BEGIN)
        walk(survey, RecordedFloor.surveyWalks.first(), nWaypoints = 3)
        val before = walks().state.value
        RuntimeEnvironment.setQualifiers("+w891dp-h411dp-land")
        survey.recreate()
        lay(survey.get())
        assertEquals(before.taps, walks().state.value.taps)
        assertTrue(survey.text(SurveyIds.ADVICE).startsWith("Gehen Sie geradeaus"))
        tap(survey, before.taps.first().copy(yM = before.taps.first().yM + 1))
        assertEquals(4, walks().state.value.taps.size)
        shoot(survey.get(), "walking-german-night-landscape")
    }

    @Test
    fun `what makes a walk worth less is said`() {
        phone.switchBluetooth(false)
        val survey = openPlan()
        survey.press(SurveyIds.BEGIN)
        tap(survey, Point2(2.0, 2.0))
        phone.pass(1_000)
        tap(survey, Point2(18.0, 2.0))
        phone.pass(2_000)
        val message = survey.text(SurveyIds.MESSAGE)
        assertTrue(message, English.warning(Warning.TOO_FAST) in message && English.warning(Warning.BLUETOOTH) in message)
        survey.press(SurveyIds.END)
        shoot(survey.get(), "refused")
        // A walk without steps is of no use to the map: its recording is dropped, and why is said.
        assertEquals(EnglishRemedies.of(WalkRefusal.NO_STEPS), survey.text(SurveyIds.MESSAGE))
        assertEquals(0, folder().recordings().size)
    }

    @Test
    fun `a phone that is not carried as a survey needs is warned of, until it is`() {
        val survey = openPlan()
        survey.press(SurveyIds.BEGIN)
        val recording = RecordedFloor.surveyWalks.first()
        walk(survey, recording, nWaypoints = 3)
        val carried = listOf(Warning.NOT_HELD, Warning.NOT_UPWARD, Warning.NOT_FORWARD, Warning.NOT_LEVEL).map(English::warning)
        val message = survey.text(SurveyIds.MESSAGE)
        assertTrue(message, carried.none { it in message })
        // Upright, as to take a picture.
        walk(survey, recording, nWaypoints = 3) { it.turned { (x, y, z) -> listOf(x, z, -y) } }
        assertTrue(survey.text(SurveyIds.MESSAGE).contains(English.warning(Warning.NOT_UPWARD)))
        shoot(survey.get(), "carried-upright")
        walk(survey, recording, nWaypoints = 4)
        val last = survey.text(SurveyIds.MESSAGE)
        assertTrue(last, carried.none { it in last })
    }

    @Test
    fun `a sensor that falls silent is told, until it speaks again`() {
        val survey = openPlan()
        survey.press(SurveyIds.BEGIN)
        val recording = RecordedFloor.surveyWalks.first()
        val isSaid = { English.warning(Warning.SENSORS) in survey.text(SurveyIds.MESSAGE) }
        for (silent in listOf("specific_force", "angular_rate", "magnetic_field")) {
            walk(survey, recording, nWaypoints = 4)
            assertFalse("all sensors speak", isSaid())
            walk(survey, recording, nWaypoints = 4) { record -> record.takeIf { silent !in it.kind } }
            assertTrue(silent, isSaid())
        }
    }

    @Test
    fun `a plan that is none is refused, and the survey on disk stays`() {
        openPlan()
        CurrentSurvey.forget()
        val start = choosePlan("no plan".toByteArray())
        assertEquals(English.planUnreadable, start.text(SurveyIds.MESSAGE))
        assertTrue(folder().isSurvey)
        assertNotNull(start.get().findViewById<View>(SurveyIds.FLOOR_NAME))
        shoot(open(StartActivity::class.java).get(), "start")
    }

    @Test
    fun `every button and the plan speak, and are large enough for a thumb`() {
        val survey = openPlan()
        val buttons = descendants(survey.get().window.decorView).filterIsInstance<Button>().toList()
        assertEquals(9, buttons.size)
        val dp = phone.context.resources.displayMetrics.density
        for (button in buttons) {
            assertTrue("${button.text}", button.contentDescription.isNotEmpty() && button.minHeight >= 48 * dp)
        }
        assertEquals(English.planDescription, survey.view<PlanView>(SurveyIds.PLAN).contentDescription)
        val (english, german) = listOf(English, German).map { texts ->
            Warning.entries.map(texts::warning) + Phase.entries.map { texts.advice(SurveyState(it)) } + texts.choosePlan
        }
        assertTrue(english.zip(german).all { (a, b) -> a.isNotEmpty() && b.isNotEmpty() && a != b })
    }

    private fun check(survey: ActivityController<SurveyActivity>) {
        survey.press(SurveyIds.CHECK)
        val check = open(CheckActivity::class.java)
        assertEquals(English.tapYourPlace, check.text(SurveyIds.ADVICE))
        var nWaypoints = 0
        records(RecordedFloor.testWalk, SensorClock.nowNs() + 1_000_000_000) { record, waypoint ->
            if (record != null) phone.deliver(record)
            if (waypoint != null && nWaypoints++ == 0) tap(check, waypoint.point)
        }
        phone.settle()
        assertTrue(check.text(SurveyIds.ADVICE).startsWith("Within"))
        shoot(check.get(), "check")
        check.pause().stop().destroy()
    }

    private fun shared(survey: ActivityController<SurveyActivity>, map: File) {
        survey.press(SurveyIds.SHARE)
        val chooser = shadowOf(survey.get()).nextStartedActivity
        @Suppress("DEPRECATION") val send = chooser.getParcelableExtra<Intent>(Intent.EXTRA_INTENT)!!
        assertTrue(send.flags and Intent.FLAG_GRANT_READ_URI_PERMISSION != 0)
        @Suppress("DEPRECATION") val uris = send.getParcelableArrayListExtra<Uri>(Intent.EXTRA_STREAM)!!
        assertEquals(1 + RecordedFloor.surveyWalks.size, uris.size)
        val provider = Robolectric.setupContentProvider(ExportProvider::class.java, uris[0].authority!!)
        val sent = provider.openFile(uris[0], "r").use { android.os.ParcelFileDescriptor.AutoCloseInputStream(it).readBytes() }
        assertTrue(sent.contentEquals(map.readBytes()))
        for (path in listOf("../../plan.geojson", "/${folder().name}/plan.geojson", "/${folder().name}")) {
            val stranger = uris[0].buildUpon().path(path).build()
            assertTrue(runCatching { provider.openFile(stranger, "r") }.exceptionOrNull() is java.io.FileNotFoundException)
        }
    }

    /** At the waypoints but the first, of which the start is known to two metres. */
    private fun meanErrorM(map: BuildingMap): Double = Positioner(map, 0).use { positioner ->
        val batch = SampleBatch()
        val errors = mutableListOf<Double>()
        var isStarted = false
        records(RecordedFloor.testWalk, 0) { record, waypoint ->
            record?.addTo(batch)
            if (waypoint == null) return@records
            positioner.pushSamples(batch.bytes())
            batch.clear()
            if (isStarted) errors.add(errorM(positioner.fixAt(waypoint.timeNs)!!, waypoint.point))
            if (!isStarted) positioner.hint(PositionHint(waypoint.point, 2.0, 0, waypoint.timeNs))
            isStarted = true
        }
        errors.average()
    }

    private fun errorM(fix: Fix, point: Point2) = hypot(fix.position.xM - point.xM, fix.position.yM - point.yM)
}
