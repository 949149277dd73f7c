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
import org.fieldwalk.Point2
import org.fieldwalk.Record
import org.fieldwalk.android.SensorClock
import org.fieldwalk.android.SimulatedPhone
import org.junit.After
import org.junit.Assert.assertEquals
import org.junit.Assert.assertFalse
import org.junit.Assert.assertTrue
import org.junit.Before
import org.robolectric.Robolectric
import org.robolectric.Shadows.shadowOf
import org.robolectric.android.controller.ActivityController
import java.io.File

/** The app's screens on a simulated phone, and a hand that taps on them. */
abstract class DrivenApp {
    protected val phone = SimulatedPhone().also { it.grantAll() }
    private val later = ArrayDeque<Runnable>()

    @Before
    fun begin() {
        CurrentSurvey.background = java.util.concurrent.Executor(later::add)
        phone.clockTo(1_000_000_000_000)
    }

    @After
    fun end() {
        CurrentSurvey.forget()
        CurrentSurvey.all(phone.context).forEach(CurrentSurvey::delete)
    }

    /** From the start screen to the survey's, by the choice of a plan. */
    protected fun openPlan(floor: String? = null): ActivityController<SurveyActivity> =
        followed(choosePlan(RecordedFloor.plan, floor))

    /** The survey's screen, as the start screen has opened it. */
    protected fun followed(start: ActivityController<StartActivity>): ActivityController<SurveyActivity> {
        val asked = shadowOf(start.get()).nextStartedActivity
        assertEquals(SurveyActivity::class.java.name, asked.component!!.className)
        return open(SurveyActivity::class.java, asked)
    }

    protected fun choosePlan(bytes: ByteArray, floor: String? = null): ActivityController<StartActivity> {
        val start = open(StartActivity::class.java)
        floor?.let(start.view<TextView>(SurveyIds.FLOOR_NAME)::setText)
        choose(start, bytes)
        return start
    }

    protected fun choose(start: ActivityController<StartActivity>, bytes: ByteArray) {
        start.press(SurveyIds.CHOOSE_PLAN)
        val plan = Uri.parse("content://plans/1")
        shadowOf(phone.context.contentResolver).registerInputStream(plan, bytes.inputStream())
        val asked = generateSequence { shadowOf(start.get()).nextStartedActivity }.first { it.action == Intent.ACTION_OPEN_DOCUMENT }
        shadowOf(start.get()).receiveResult(asked, Activity.RESULT_OK, Intent().setData(plan))
    }

    /**
     * The walk of [recording], tapped where the surveyor stood, up to so many waypoints; what the phone feels may be turned, or
     * not be felt at all.
     */
    protected fun walk(
        survey: ActivityController<SurveyActivity>,
        recording: File,
        nWaypoints: Int = Int.MAX_VALUE,
        felt: (Record) -> Record? = { it },
    ) {
        var n = 0
        records(recording, SensorClock.nowNs() + 1_000_000_000) { record, waypoint ->
            if (n >= nWaypoints) return@records
            record?.let(felt)?.let(phone::deliver)
            if (waypoint != null) {
                phone.clockTo(waypoint.timeNs)
                tap(survey, waypoint.point)
                n += 1
            }
        }
        phone.settle()
    }

    protected fun tap(activity: ActivityController<*>, point: Point2) {
        val plan = activity.view<PlanView>(SurveyIds.PLAN)
        val viewport = plan.viewport!!
        val (x, y) = viewport.xPx(point).toFloat() to viewport.yPx(point).toFloat()
        val now = SystemClock.uptimeMillis()
        for (action in listOf(MotionEvent.ACTION_DOWN, MotionEvent.ACTION_UP)) {
            plan.dispatchTouchEvent(MotionEvent.obtain(now, now, action, x, y, 0))
        }
    }

    /** By default of the newest survey, as after the end of the app. */
    protected fun <A : Activity> open(type: Class<A>, intent: Intent? = null): ActivityController<A> {
        val newest = CurrentSurvey.all(phone.context).firstOrNull()
        val asked = intent ?: Intent(phone.context, type).apply { newest?.let { of(it.name) } }
        return Robolectric.buildActivity(type, asked).setup().also { lay(it.get()) }
    }

    /** Of the newest survey. */
    protected fun folder() = CurrentSurvey.all(phone.context).first()

    protected fun walks() = CurrentSurvey.of(phone.context, folder().name)!!

    protected fun lay(activity: Activity) {
        phone.settle()
        val view = activity.window.decorView
        val metrics = activity.resources.displayMetrics
        val exactly = { px: Int -> View.MeasureSpec.makeMeasureSpec(px, View.MeasureSpec.EXACTLY) }
        view.measure(exactly(metrics.widthPixels), exactly(metrics.heightPixels))
        view.layout(0, 0, metrics.widthPixels, metrics.heightPixels)
    }

    protected fun ActivityController<*>.press(id: Int) {
        phone.settle()
        val button = view<Button>(id)
        assertTrue("${button.text} is there", button.isEnabled && button.visibility == View.VISIBLE)
        button.performClick()
        phone.settle()
    }

    protected fun ActivityController<*>.text(id: Int): String {
        phone.settle()
        return view<TextView>(id).text.toString()
    }

    protected fun <V : View> ActivityController<*>.view(id: Int): V = (get() as Activity).requireViewById(id)

    protected fun runLater() {
        while (later.isNotEmpty()) later.removeFirst().run()
        phone.settle()
        assertFalse(walks().state.value.phase == Phase.BUILDING)
    }

    protected fun descendants(view: View): Sequence<View> = sequence {
        yield(view)
        if (view is ViewGroup) for (k in 0..<view.childCount) yieldAll(descendants(view.getChildAt(k)))
    }

    /** To be looked at. */
    protected fun shoot(activity: Activity, name: String) {
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
