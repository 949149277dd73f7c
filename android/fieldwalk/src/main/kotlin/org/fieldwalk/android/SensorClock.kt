package org.fieldwalk.android

import android.os.SystemClock
import kotlin.math.abs

/** The clock of all samples: nanoseconds since the device booted, sleep included. Nobody sets it. */
object SensorClock {
    /** Now. */
    fun nowNs(): Long = SystemClock.elapsedRealtimeNanos()
}

/**
 * Brings a sensor's stamps to [SensorClock].
 *
 * Android asks for stamps on that clock; some devices count from elsewhere, such as without sleep or since 1970. A sensor's
 * first event is new, so a stamp far from now is of another clock, and the distance is that of the clocks.
 */
internal class StampAlignment {
    private var offsetNs: Long? = null

    /** The stamp on [SensorClock] of an event stamped [timeNs] and delivered at [nowNs]. */
    fun aligned(timeNs: Long, nowNs: Long): Long {
        val offset = offsetNs ?: (nowNs - timeNs).let { if (abs(it) > OTHER_CLOCK_NS) it else 0 }.also { offsetNs = it }
        return timeNs + offset
    }

    private companion object {
        /** No first event is so late. */
        const val OTHER_CLOCK_NS = 10_000_000_000
    }
}
