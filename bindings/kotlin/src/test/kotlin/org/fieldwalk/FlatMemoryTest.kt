package org.fieldwalk

import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Test

class FlatMemoryTest {
    /** A process that holds so much, time by time. */
    private fun held(vararg kb: Long, leastTimes: Int = 1): List<Long> {
        var nTimes = 0
        return FlatMemory.after(8_000, leastTimes, { kb[nTimes - 1] }) { nTimes++ }
    }

    @Test
    fun `what comes to an end is flat`() {
        // As measured.
        assertEquals(4, held(391_152, 393_316, 394_376, 395_372).size)
        assertEquals(4, held(389_588, 384_160, 385_524, 386_416).size)
        // As it might be on another machine.
        assertEquals(5, held(380_000, 388_000, 391_000, 392_000, 392_100).size)
        // Flat after four, the others are done all the same.
        assertEquals(listOf(1L, 2, 3, 4, 9_000), held(1, 2, 3, 4, 9_000, leastTimes = 5))
    }

    @Test
    fun `what grows is not, though by fits and starts`() {
        fun refused(vararg kb: Long) = assertThrows(IllegalStateException::class.java) { held(*kb) }
        refused(*LongArray(FlatMemory.MOST_TIMES) { 380_000L + 3_000 * it })
        // As measured with one positioner of a hundred kept.
        refused(391_512, 393_204, 401_452, 414_492, 419_604, 420_872, 428_484, 439_864, 441_168)
    }
}
