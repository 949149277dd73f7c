package org.fieldwalk

import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Test

class FlatMemoryTest {
    /** A process that holds so much, time by time. */
    private fun held(vararg kb: Long, leastTimes: Int = 2): List<Long> {
        var nTimes = 0
        return FlatMemory.after(2_000, leastTimes, { kb[nTimes - 1] }) { nTimes++ }
    }

    @Test
    fun `what comes to an end is flat`() {
        assertEquals(listOf(380_000L, 390_000, 399_000, 399_500), held(380_000, 390_000, 399_000, 399_500))
        // The first of three was flat, the others are done all the same.
        assertEquals(listOf(1L, 2, 5_000), held(1, 2, 5_000, leastTimes = 3))
    }

    @Test
    fun `what grows each time is not, though the collector takes some back`() {
        assertThrows(IllegalStateException::class.java) { held(*LongArray(8) { 380_000L + 5_000 * it }) }
        assertThrows(IllegalStateException::class.java) { held(0, 9_000, 12_000, 20_000, 23_000, 31_000, 34_000, 42_000) }
    }
}
