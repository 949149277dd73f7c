package org.fieldwalk.android

/**
 * How often something may be begun.
 *
 * Android gives no results to an app that begins a Bluetooth scan for the sixth time in 30 s, or asks for a fifth WiFi scan in
 * two minutes, and tells neither.
 */
internal class ScanBudget(private val nStarts: Int, private val perMs: Long) {
    private val startsMs = ArrayDeque<Long>()

    /** Takes a start at [nowMs] of the monotonic clock; false when there is none left. */
    fun take(nowMs: Long): Boolean {
        // A start in the future is of a clock that has begun anew, as between tests.
        startsMs.removeIf { nowMs - it !in 0..<perMs }
        if (startsMs.size == nStarts) return false
        startsMs.addLast(nowMs)
        return true
    }
}
