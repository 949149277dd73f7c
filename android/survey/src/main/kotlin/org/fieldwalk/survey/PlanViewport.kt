package org.fieldwalk.survey

import org.fieldwalk.Point2

/** Where a plan lies on a screen: metres with y up, pixels with y down. */
data class PlanViewport(
    val planWidthM: Double,
    val planHeightM: Double,
    val screenWidthPx: Double,
    val screenHeightPx: Double,
    /** Pixels a metre. */
    val scale: Double,
    /** Which place of the plan is at the screen's middle. */
    val centre: Point2,
) {
    fun xPx(point: Point2): Double = screenWidthPx / 2 + scale * (point.xM - centre.xM)

    fun yPx(point: Point2): Double = screenHeightPx / 2 - scale * (point.yM - centre.yM)

    /** The place of the plan at a pixel; null beside the plan. */
    fun point(xPx: Double, yPx: Double): Point2? = unbounded(xPx, yPx)
        .takeIf { it.xM in 0.0..planWidthM && it.yM in 0.0..planHeightM }

    /** [factor] times as large, the place under the pixel staying where it is; from the whole plan to 200 pixels a metre. */
    fun zoomed(factor: Double, xPx: Double, yPx: Double): PlanViewport {
        if (!factor.isFinite() || factor <= 0) return this
        val whole = wholeScale(planWidthM, planHeightM, screenWidthPx, screenHeightPx)
        val zoomed = copy(scale = (scale * factor).coerceIn(whole, maxOf(200.0, whole)))
        val (anchor, moved) = unbounded(xPx, yPx) to zoomed.unbounded(xPx, yPx)
        return zoomed.around(centre.xM + anchor.xM - moved.xM, centre.yM + anchor.yM - moved.yM)
    }

    /** Dragged by so many pixels; the screen's middle stays on the plan. */
    fun dragged(xPx: Double, yPx: Double): PlanViewport = around(centre.xM - xPx / scale, centre.yM + yPx / scale)

    private fun unbounded(xPx: Double, yPx: Double) =
        Point2(centre.xM + (xPx - screenWidthPx / 2) / scale, centre.yM - (yPx - screenHeightPx / 2) / scale)

    private fun around(xM: Double, yM: Double) =
        copy(centre = Point2(xM.coerceIn(0.0, planWidthM), yM.coerceIn(0.0, planHeightM)))

    companion object {
        /** The whole plan, as large as it fits with a margin of a twentieth. */
        fun whole(planWidthM: Double, planHeightM: Double, screenWidthPx: Int, screenHeightPx: Int): PlanViewport {
            val (planX, planY) = maxOf(planWidthM, 0.1) to maxOf(planHeightM, 0.1)
            val (screenX, screenY) = maxOf(screenWidthPx, 1).toDouble() to maxOf(screenHeightPx, 1).toDouble()
            val scale = wholeScale(planX, planY, screenX, screenY)
            return PlanViewport(planX, planY, screenX, screenY, scale, Point2(planX / 2, planY / 2))
        }

        private fun wholeScale(planX: Double, planY: Double, screenX: Double, screenY: Double) =
            0.95 * minOf(screenX / planX, screenY / planY)
    }
}
