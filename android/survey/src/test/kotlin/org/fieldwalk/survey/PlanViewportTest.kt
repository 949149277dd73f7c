package org.fieldwalk.survey

import org.fieldwalk.Point2
import org.junit.Assert.assertEquals
import org.junit.Assert.assertNull
import org.junit.Test

class PlanViewportTest {
    private val whole = PlanViewport.whole(40.0, 20.0, 400, 800)

    @Test
    fun `the whole plan fits, with y up`() {
        assertEquals(9.5, whole.scale, 1e-12)
        assertEquals(200.0 to 400.0, Point2(20.0, 10.0).let { whole.xPx(it) to whole.yPx(it) })
        assertEquals(10.0, whole.xPx(Point2(0.0, 0.0)), 1e-9)
        assertEquals(495.0, whole.yPx(Point2(0.0, 0.0)), 1e-9)
        assertEquals(Point2(0.0, 20.0), whole.point(10.0, 305.0))
        assertNull(whole.point(9.0, 400.0))
    }

    @Test
    fun `a pinch keeps the place under the fingers, within bounds`() {
        val near = whole.zoomed(3.0, 100.0, 350.0)
        val (before, after) = whole.point(100.0, 350.0)!! to near.point(100.0, 350.0)!!
        assertEquals(before.xM, after.xM, 1e-9)
        assertEquals(before.yM, after.yM, 1e-9)
        assertEquals(whole.scale, whole.zoomed(0.1, 0.0, 0.0).scale, 1e-12)
        assertEquals(200.0, whole.zoomed(1e9, 0.0, 0.0).scale, 1e-12)
        assertEquals(whole, whole.zoomed(Double.NaN, 0.0, 0.0))
        assertEquals(Point2(0.0, 10.0), whole.dragged(1e6, 0.0).centre)
    }

    @Test
    fun `exported files have plain names`() {
        assertEquals("2-OG-Nord.map.tar", exportName("2. OG / Nord", "map.tar"))
        assertEquals("floor.1.mcap", exportName("…", "1.mcap"))
    }
}
