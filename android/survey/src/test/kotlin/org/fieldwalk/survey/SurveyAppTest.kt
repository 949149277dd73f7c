package org.fieldwalk.survey

import android.app.Activity
import android.content.Intent
import android.graphics.Bitmap
import android.graphics.Canvas
import android.net.Uri
import android.os.SystemClock
import android.view.MotionEvent
import android.view.View
import android.view.ViewGroup
import android.widget.Button
import android.widget.TextView
import org.fieldwalk.BuildingMap
import org.fieldwalk.Fix
import org.fieldwalk.Point2
import org.fieldwalk.PositionHint
import org.fieldwalk.Positioner
import org.fieldwalk.Record
import org.fieldwalk.SampleBatch
import org.fieldwalk.WalkRefusal
import org.fieldwalk.android.SensorClock
import org.fieldwalk.android.SimulatedPhone
import org.junit.After
import org.junit.Assert.assertEquals
import org.junit.Assert.assertFalse
import org.junit.Assert.assertNotNull
import org.junit.Assert.assertTrue
import org.junit.Before
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
class SurveyAppTest {
    private val phone = SimulatedPhone().also { it.grantAll() }
    private val later = ArrayDeque<Runnable>()

    @Before
    fun begin() {
        CurrentSurvey.background = java.util.concurrent.Executor(later::add)
        phone.clockTo(1_000_000_000_000)
    }

    @After
    fun end() {
        CurrentSurvey.forget()
        CurrentSurvey.folder(phone.context).folder.deleteRecursively()
    }

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
        val state = CurrentSurvey.of(phone.context)!!.state.value
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

        val map = CurrentSurvey.folder(phone.context).mapFile
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
        val whole = CurrentSurvey.of(phone.context)!!.state.value
        survey.press(SurveyIds.BEGIN)
        walk(survey, second, nWaypoints = 4)
        val (taps, coverage) = CurrentSurvey.of(phone.context)!!.state.value.let { it.taps to it.coverage!!.totals }
        assertEquals(4, taps.size)
        // The process is gone; nothing was saved on its way out.
        CurrentSurvey.forget()

        val again = open(SurveyActivity::class.java)
        val state = CurrentSurvey.of(phone.context)!!.state.value
        assertEquals(null, state.mishap)
        assertEquals(whole.walkLengthsM[0], state.walkLengthsM[0], 1e-9)
        assertEquals("the cut walk counts up to its last waypoint", 2, state.nWalks)
        assertEquals(coverage.coveredM2, state.coverage!!.totals.coveredM2, 1e-9)
        assertTrue(again.text(SurveyIds.SUMMARY).startsWith("2 walks"))
        // And the survey goes on.
        again.press(SurveyIds.BEGIN)
        walk(again, second, nWaypoints = 3)
        again.press(SurveyIds.END)
        assertEquals(3, CurrentSurvey.of(phone.context)!!.state.value.nWalks)
        again.press(SurveyIds.UNDO_WALK)
        assertEquals(2, CurrentSurvey.folder(phone.context).recordings().size)
    }

    @Test
    fun `what was undone and paused stays so after the end of the app`() {
        val survey = openPlan()
        survey.press(SurveyIds.BEGIN)
        val recording = RecordedFloor.surveyWalks.first()
        walk(survey, recording, nWaypoints = 3)
        survey.press(SurveyIds.UNDO_TAP)
        assertEquals(2, CurrentSurvey.of(phone.context)!!.state.value.taps.size)
        survey.press(SurveyIds.PAUSE)
        assertEquals(Phase.PAUSED, CurrentSurvey.of(phone.context)!!.state.value.phase)
        assertEquals(View.VISIBLE, survey.view<Button>(SurveyIds.RESUME).visibility)
        survey.press(SurveyIds.RESUME)
        walk(survey, recording, nWaypoints = 2)
        val covered = CurrentSurvey.of(phone.context)!!.state.value.coverage!!.totals
        CurrentSurvey.forget()
        val restored = CurrentSurvey.of(phone.context)!!.state.value
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
        val before = CurrentSurvey.of(phone.context)!!.state.value
        RuntimeEnvironment.setQualifiers("+w891dp-h411dp-land")
        survey.recreate()
        lay(survey.get())
        assertEquals(before.taps, CurrentSurvey.of(phone.context)!!.state.value.taps)
        assertTrue(survey.text(SurveyIds.ADVICE).startsWith("Gehen Sie geradeaus"))
        tap(survey, before.taps.first().copy(yM = before.taps.first().yM + 1))
        assertEquals(4, CurrentSurvey.of(phone.context)!!.state.value.taps.size)
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
        assertEquals(0, CurrentSurvey.folder(phone.context).recordings().size)
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
    fun `a plan that is none is refused, and the survey on disk stays`() {
        openPlan()
        CurrentSurvey.forget()
        val start = choosePlan("no plan".toByteArray())
        assertEquals(English.planUnreadable, start.text(SurveyIds.MESSAGE))
        assertTrue(CurrentSurvey.folder(phone.context).isSurvey)
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
        val stranger = uris[0].buildUpon().path("../../plan.geojson").build()
        assertTrue(runCatching { provider.openFile(stranger, "r") }.exceptionOrNull() is java.io.FileNotFoundException)
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

    /** From the start screen to the survey's, by the choice of a plan. */
    private fun openPlan(): ActivityController<SurveyActivity> {
        val start = choosePlan(RecordedFloor.plan)
        assertEquals(SurveyActivity::class.java.name, shadowOf(start.get()).nextStartedActivity.component!!.className)
        return open(SurveyActivity::class.java)
    }

    private fun choosePlan(bytes: ByteArray): ActivityController<StartActivity> {
        val start = open(StartActivity::class.java)
        start.press(SurveyIds.CHOOSE_PLAN)
        val plan = Uri.parse("content://plans/1")
        shadowOf(phone.context.contentResolver).registerInputStream(plan, bytes.inputStream())
        val asked = generateSequence { shadowOf(start.get()).nextStartedActivity }.first { it.action == Intent.ACTION_OPEN_DOCUMENT }
        shadowOf(start.get()).receiveResult(asked, Activity.RESULT_OK, Intent().setData(plan))
        return start
    }

    /** The walk of [recording], tapped where the surveyor stood, up to so many waypoints; what the phone feels may be turned. */
    private fun walk(
        survey: ActivityController<SurveyActivity>,
        recording: File,
        nWaypoints: Int = Int.MAX_VALUE,
        felt: (Record) -> Record = { it },
    ) {
        var n = 0
        records(recording, SensorClock.nowNs() + 1_000_000_000) { record, waypoint ->
            if (n >= nWaypoints) return@records
            if (record != null) phone.deliver(felt(record))
            if (waypoint != null) {
                phone.clockTo(waypoint.timeNs)
                tap(survey, waypoint.point)
                n += 1
            }
        }
        phone.settle()
    }

    private fun tap(activity: ActivityController<*>, point: Point2) {
        val plan = activity.view<PlanView>(SurveyIds.PLAN)
        val viewport = plan.viewport!!
        val (x, y) = viewport.xPx(point).toFloat() to viewport.yPx(point).toFloat()
        val now = SystemClock.uptimeMillis()
        for (action in listOf(MotionEvent.ACTION_DOWN, MotionEvent.ACTION_UP)) {
            plan.dispatchTouchEvent(MotionEvent.obtain(now, now, action, x, y, 0))
        }
    }

    private fun <A : Activity> open(type: Class<A>): ActivityController<A> =
        Robolectric.buildActivity(type).setup().also { lay(it.get()) }

    private fun lay(activity: Activity) {
        phone.settle()
        val view = activity.window.decorView
        val metrics = activity.resources.displayMetrics
        val exactly = { px: Int -> View.MeasureSpec.makeMeasureSpec(px, View.MeasureSpec.EXACTLY) }
        view.measure(exactly(metrics.widthPixels), exactly(metrics.heightPixels))
        view.layout(0, 0, metrics.widthPixels, metrics.heightPixels)
    }

    private fun ActivityController<*>.press(id: Int) {
        phone.settle()
        val button = view<Button>(id)
        assertTrue("${button.text} is there", button.isEnabled && button.visibility == View.VISIBLE)
        button.performClick()
        phone.settle()
    }

    private fun ActivityController<*>.text(id: Int): String {
        phone.settle()
        return view<TextView>(id).text.toString()
    }

    private fun <V : View> ActivityController<*>.view(id: Int): V = (get() as Activity).requireViewById(id)

    private fun runLater() {
        while (later.isNotEmpty()) later.removeFirst().run()
        phone.settle()
        assertFalse(CurrentSurvey.of(phone.context)!!.state.value.phase == Phase.BUILDING)
    }

    private fun descendants(view: View): Sequence<View> = sequence {
        yield(view)
        if (view is ViewGroup) for (k in 0..<view.childCount) yieldAll(descendants(view.getChildAt(k)))
    }

    /** To be looked at. */
    private fun shoot(activity: Activity, name: String) {
        lay(activity)
        val view = activity.window.decorView
        val picture = Bitmap.createBitmap(view.width, view.height, Bitmap.Config.ARGB_8888)
        view.draw(Canvas(picture))
        val colours = (0..<picture.width step 7).flatMap { x -> (0..<picture.height step 7).map { y -> picture.getPixel(x, y) } }
        assertTrue("$name is not blank", colours.toSet().size > 8)
        val file = File(System.getProperty("fieldwalk.screenshots")!!, "$name.png")
        file.parentFile!!.mkdirs()
        file.outputStream().use { picture.compress(Bitmap.CompressFormat.PNG, 100, it) }
    }
}
