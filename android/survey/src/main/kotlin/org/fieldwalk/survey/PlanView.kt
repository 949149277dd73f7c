package org.fieldwalk.survey

import android.annotation.SuppressLint
import android.content.Context
import android.content.res.Configuration
import android.graphics.Canvas
import android.graphics.Color
import android.graphics.Paint
import android.graphics.Path
import android.graphics.Rect
import android.graphics.RectF
import android.graphics.Bitmap
import android.view.GestureDetector
import android.view.MotionEvent
import android.view.ScaleGestureDetector
import android.view.View
import org.fieldwalk.Fix
import org.fieldwalk.FloorDrawing
import org.fieldwalk.Point2
import org.fieldwalk.ScoredPlace
import org.fieldwalk.SurveyCoverage

/** The plan with what is covered and what errors to expect; to look at, to drag and pinch, to tap on. */
@SuppressLint("ViewConstructor") // Made in code alone.
class PlanView(context: Context, private val drawing: FloorDrawing, private val tapped: (Point2) -> Unit) : View(context) {
    private val isNight = resources.configuration.uiMode and Configuration.UI_MODE_NIGHT_MASK ==
        Configuration.UI_MODE_NIGHT_YES
    private val dp = resources.displayMetrics.density
    private val ground = if (isNight) 0xFF101418.toInt() else 0xFFF7F7F5.toInt()
    private val wall = stroke(if (isNight) 0xFFA0A8B0.toInt() else 0xFF5A6068.toInt(), 1f)
    private val way = stroke(if (isNight) 0xFF3A4450.toInt() else 0xFFD8DCE0.toInt(), 1f)
    private val route = stroke(ACCENT, 3f)
    private val dot = Paint(Paint.ANTI_ALIAS_FLAG).apply { color = ACCENT }
    private val place = Paint(Paint.ANTI_ALIAS_FLAG)
    private var image: Bitmap? = null
    private var coverage: SurveyCoverage? = null
    private var taps = emptyList<Point2>()
    private var places = emptyList<ScoredPlace>()
    private var fix: Fix? = null

    /** Null until the view has its size. */
    var viewport: PlanViewport? = null
        private set

    private val gestures = GestureDetector(context, object : GestureDetector.SimpleOnGestureListener() {
        override fun onDown(event: MotionEvent) = true

        override fun onSingleTapUp(event: MotionEvent): Boolean {
            performClick()
            viewport?.point(event.x.toDouble(), event.y.toDouble())?.let(tapped)
            return true
        }

        override fun onScroll(first: MotionEvent?, event: MotionEvent, xPx: Float, yPx: Float): Boolean {
            viewport = viewport?.dragged(-xPx.toDouble(), -yPx.toDouble())
            invalidate()
            return true
        }
    })
    private val pinches = ScaleGestureDetector(context, object : ScaleGestureDetector.SimpleOnScaleGestureListener() {
        override fun onScale(detector: ScaleGestureDetector): Boolean {
            val (x, y) = detector.focusX.toDouble() to detector.focusY.toDouble()
            viewport = viewport?.zoomed(detector.scaleFactor.toDouble(), x, y)
            invalidate()
            return true
        }
    })

    fun show(state: SurveyState) {
        if (coverage !== state.coverage) {
            coverage = state.coverage
            image = state.coverage?.let { CoverageImage.bitmap(it, isNight) }
        }
        taps = state.taps
        places = state.accuracy?.places.orEmpty()
        invalidate()
    }

    fun show(fix: Fix?) {
        this.fix = fix
        invalidate()
    }

    override fun onSizeChanged(width: Int, height: Int, oldWidth: Int, oldHeight: Int) {
        viewport = PlanViewport.whole(drawing.widthM, drawing.heightM, width, height)
    }

    @SuppressLint("ClickableViewAccessibility") // The gesture detector calls performClick.
    override fun onTouchEvent(event: MotionEvent): Boolean {
        val isPinched = pinches.onTouchEvent(event) && pinches.isInProgress
        return isPinched || gestures.onTouchEvent(event)
    }

    override fun onDraw(canvas: Canvas) {
        val viewport = viewport ?: return
        canvas.drawColor(ground)
        drawCoverage(canvas, viewport)
        drawing.pathways.forEach { canvas.drawPath(path(it, viewport, isClosed = false), way) }
        drawing.units.flatMap { it.rings }.forEach { canvas.drawPath(path(it, viewport, isClosed = true), wall) }
        drawing.outline.forEach { canvas.drawPath(path(it, viewport, isClosed = true), wall) }
        drawing.walls.forEach { canvas.drawPath(path(it, viewport, isClosed = false), wall) }
        for (scored in places) {
            place.color = ErrorColour.of(scored.errorM)
            circle(canvas, viewport, scored.point, 5 * dp, place)
        }
        canvas.drawPath(path(taps, viewport, isClosed = false), route)
        taps.forEach { circle(canvas, viewport, it, 6 * dp, dot) }
        fix?.let { drawFix(canvas, viewport, it) }
    }

    private fun drawCoverage(canvas: Canvas, viewport: PlanViewport) {
        val (image, coverage) = (image ?: return) to (coverage ?: return)
        // Each pixel has its node in its middle: the image begins half a node before the origin.
        val halfM = coverage.cellM / 2
        val (widthM, heightM) = coverage.cellM * image.width to coverage.cellM * image.height
        val (low, high) = Point2(-halfM, -halfM) to Point2(widthM - halfM, heightM - halfM)
        val place = RectF(
            viewport.xPx(low).toFloat(), viewport.yPx(high).toFloat(), viewport.xPx(high).toFloat(), viewport.yPx(low).toFloat(),
        )
        canvas.drawBitmap(image, Rect(0, 0, image.width, image.height), place, null)
    }

    private fun drawFix(canvas: Canvas, viewport: PlanViewport, fix: Fix) {
        place.color = ACCENT and 0x00FFFFFF or 0x33000000
        circle(canvas, viewport, fix.position, (fix.radius68M * viewport.scale).toFloat(), place)
        circle(canvas, viewport, fix.position, 8 * dp, dot)
    }

    private fun circle(canvas: Canvas, viewport: PlanViewport, at: Point2, radiusPx: Float, paint: Paint) =
        canvas.drawCircle(viewport.xPx(at).toFloat(), viewport.yPx(at).toFloat(), radiusPx, paint)

    private fun path(points: List<Point2>, viewport: PlanViewport, isClosed: Boolean) = Path().apply {
        points.forEachIndexed { k, point ->
            val (x, y) = viewport.xPx(point).toFloat() to viewport.yPx(point).toFloat()
            if (k == 0) moveTo(x, y) else lineTo(x, y)
        }
        if (isClosed) close()
    }

    private fun stroke(colour: Int, widthDp: Float) = Paint(Paint.ANTI_ALIAS_FLAG).apply {
        color = colour
        style = Paint.Style.STROKE
        strokeWidth = widthDp * dp
        strokeJoin = Paint.Join.ROUND
    }

    private companion object {
        const val ACCENT = 0xFF2F6FED.toInt()
    }
}

/** How large an error to expect, as a colour that people tell apart who do not tell red from green. */
object ErrorColour {
    /** Blue under a metre, yellow at two to three, dark red from five metres. */
    fun of(errorM: Double): Int = when {
        errorM < 1 -> 0xFF2B83BA.toInt()
        errorM < 2 -> 0xFF7FBFA0.toInt()
        errorM < 3 -> 0xFFE8C34A.toInt()
        errorM < 5 -> 0xFFE07B39.toInt()
        else -> 0xFFB2182B.toInt()
    }
}

/** A coverage grid as an image to lay over the plan: a pixel a node, the highest y in the first row. */
object CoverageImage {
    /** Null when the grid holds another number of nodes than it says. */
    fun bitmap(coverage: SurveyCoverage, isNight: Boolean): Bitmap? {
        val (columns, rows) = coverage.nColumns.toInt() to coverage.nRows.toInt()
        if (columns <= 0 || rows <= 0 || coverage.nodes.size != columns * rows) return null
        val colours = IntArray(columns * rows) { k ->
            val row = rows - 1 - k / columns
            colour(coverage.nodes[row * columns + k % columns].toInt(), isNight)
        }
        return Bitmap.createBitmap(colours, columns, rows, Bitmap.Config.ARGB_8888)
    }

    private fun colour(node: Int, isNight: Boolean) = when (node) {
        OPEN -> if (isNight) 0x33FFB04A else 0x33E08A00
        COVERED -> if (isNight) 0x6600B48C else 0x5500A07C
        else -> Color.TRANSPARENT
    }

    private const val OPEN = 1
    private const val COVERED = 2
}
