package org.fieldwalk.android

import org.fieldwalk.SampleBatch

/** Takes batches, one at a time; each is valid during the call only. */
internal fun interface BatchSink {
    fun push(batch: SampleBatch)
}

/**
 * From a start to its end: samples of all sensors, packed and pushed.
 *
 * Whoever delivers a sample pushes too, one at a time, so that nothing is queued between the sensors and the engine. What comes
 * of it is handed on by [pushed], outside the lock: whoever receives it may stop the sensors.
 */
internal class SensorRun(
    latencyMs: Int,
    /** When it throws, no further batch is given. */
    private val sink: BatchSink,
    /** Called after a batch, without the lock. */
    @PublishedApi internal val pushed: () -> Unit,
    /** Called once, with what [sink] threw, under the lock: it must not wait. */
    private val fail: (Throwable) -> Unit,
) {
    @PublishedApi internal val lock = Any()
    @PublishedApi internal val batch = SampleBatch()
    private val latencyNs = latencyMs.coerceIn(0, MAX_LATENCY_MS) * 1_000_000L
    private var firstNs: Long? = null
    private var isOver = false

    /** Adds the sample of [timeNs] that [write] packs, and pushes when enough wait. */
    inline fun take(timeNs: Long, write: SampleBatch.() -> Unit) {
        val hasPushed = synchronized(lock) {
            if (isOpen()) batch.write()
            afterSample(timeNs)
        }
        if (hasPushed) pushed()
    }

    /** Pushes what waits. */
    fun flush() {
        if (synchronized(lock) { pushBatch() }) pushed()
    }

    /** Pushes what waits and takes no further samples. */
    fun end() {
        val hasPushed = synchronized(lock) { pushBatch().also { isOver = true } }
        if (hasPushed) pushed()
    }

    @PublishedApi internal fun isOpen() = !isOver

    /** Whether a batch was pushed. */
    @PublishedApi internal fun afterSample(timeNs: Long): Boolean {
        val first = firstNs ?: timeNs.also { firstNs = it }
        // Far apart either way: stamps may be any numbers.
        return timeNs - first !in -latencyNs + 1..<latencyNs && pushBatch()
    }

    private fun pushBatch(): Boolean {
        if (batch.size == 0 || isOver) return false
        try {
            sink.push(batch)
        } catch (failure: Exception) {
            isOver = true
            fail(failure)
        }
        batch.clear()
        firstNs = null
        return true
    }

    companion object {
        /** Half of the engine's reorder window, in ms: a batch and its way here together stay inside. */
        const val MAX_LATENCY_MS = 100
    }
}
