package org.fieldwalk.android

import android.content.Context
import kotlinx.coroutines.channels.BufferOverflow
import kotlinx.coroutines.channels.awaitClose
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.MutableStateFlow
import kotlinx.coroutines.flow.StateFlow
import kotlinx.coroutines.flow.asStateFlow
import kotlinx.coroutines.flow.buffer
import kotlinx.coroutines.flow.callbackFlow
import org.fieldwalk.ApiException
import org.fieldwalk.BuildingMap
import org.fieldwalk.Fix
import org.fieldwalk.PositionHint
import org.fieldwalk.Positioner
import org.fieldwalk.PositionerOptions
import org.fieldwalk.SampleBatch
import org.fieldwalk.SensorLoop
import org.fieldwalk.Status
import java.util.concurrent.ConcurrentLinkedQueue
import java.util.concurrent.CopyOnWriteArraySet
import java.util.concurrent.atomic.AtomicBoolean

/**
 * Follows one wearer on one floor: sensors in, a flow of fixes out. Made by [Fieldwalk.positioner].
 *
 * Sensors run while somebody collects [fixes], and from [start] to [stop]. What was known is kept from run to run. Every
 * call may come from any thread, and [start], [stop] and [close] any number of times.
 */
class PositioningSession internal constructor(
    context: Context,
    map: BuildingMap,
    floor: Int,
    options: PositionerOptions,
    sensing: Sensing,
) : AutoCloseable {
    private val positioner = Positioner(map, floor, options)
    /** Pushes without garbage, where the library can. */
    private val loop = if (SensorLoop.isSupported) SensorLoop(positioner) else null
    private val sensors = PhoneSensors(
        context, sensing, map.ibeaconUuids(), map.hasAccessPoints(), BatchSink(::push), ::handOn, ::report, ::fail,
    )
    private val readers = CopyOnWriteArraySet<Reader>()
    private val state = MutableStateFlow(PositioningStatus(isRunning = false, troubles = emptyList()))
    private val lock = Any()
    private val fresh = ConcurrentLinkedQueue<Fix>()
    private val isHandingOn = AtomicBoolean()

    /** Guarded by [lock]. */
    private var isStarted = false
    private var isClosed = false

    @Volatile private var failure: Throwable? = null
    @Volatile private var phoneTroubles = emptyList<Trouble>()

    /** Whether it runs, and what it lacks; of the engine's wants it tells once a second. */
    val status: StateFlow<PositioningStatus> = state.asStateFlow()

    /**
     * A fix for every step, while the flow is collected. A collector that lags behind finds the newest 256.
     *
     * The flow ends with [stop] and [close]; after a fault of Fieldwalk itself it throws [ApiException.Broken]. Of a closed
     * session it is empty.
     */
    fun fixes(): Flow<Fix> = callbackFlow {
        val reader = Reader(take = { trySend(it) }, end = { close(it) })
        attach(reader)
        awaitClose { detach(reader) }
    }.buffer(256, BufferOverflow.DROP_OLDEST)

    /** Runs the sensors also while nobody collects, such as in [PositioningService]. */
    fun start() = check(startUnlessClosed()) { "the session is closed" }

    /** Whether it could be started. */
    internal fun startUnlessClosed(): Boolean = synchronized(lock) {
        if (isClosed) return false
        isStarted = true
        run()
        true
    }

    /** Stops the sensors and ends every flow of [fixes]. */
    fun stop() = synchronized(lock) {
        isStarted = false
        rest()
        endReaders(null)
    }

    /** Stops for good. */
    override fun close(): Unit = synchronized(lock) {
        if (!isClosed) {
            isClosed = true
            stop()
            loop?.close()
            positioner.close()
        }
    }

    /**
     * Starts, or starts anew, from a place that somebody knows.
     *
     * @throws ApiException when the hint is on another floor or no place on the plan
     */
    fun hint(hint: PositionHint) = positioner.hint(hint)

    /** The fix at the last consumed sample; null before a hint or the first steps. */
    fun fix(): Fix? = positioner.fix()

    /**
     * The fix at a time on [SensorClock], the open step extrapolated; it changes nothing, so a display may ask as often as
     * it draws.
     *
     * @throws ApiException.TimeInPast before the last consumed sample
     */
    fun fixAt(timeNs: Long): Fix? = positioner.fixAt(timeNs)

    /** What was left out so far, and why. */
    fun engineStatus(): Status = positioner.status()

    /** Looks anew at permissions and switches; for `onResume`, otherwise it happens every second. */
    fun refresh() = sensors.refresh()

    /** All that is remembered, to go on from after a restart of the app; for this version of the library only. */
    fun snapshot(): ByteArray = positioner.snapshot()

    /**
     * Goes on from [snapshot] as if nothing had happened in between.
     *
     * @throws ApiException when the bytes are no snapshot, or one of another version, system, seed or floor
     */
    fun restore(snapshot: ByteArray) = positioner.restore(snapshot.toDirect())

    private class Reader(val take: (Fix) -> Unit, val end: (Throwable?) -> Unit)

    private fun attach(reader: Reader) = synchronized(lock) {
        val failure = failure
        if (isClosed || failure != null) {
            reader.end(failure)
        } else {
            readers.add(reader)
            run()
        }
    }

    private fun detach(reader: Reader) = synchronized(lock) {
        readers.remove(reader)
        if (readers.isEmpty() && !isStarted) rest()
    }

    /** Under the lock. */
    private fun run() {
        if (state.value.isRunning) return
        state.value = PositioningStatus(isRunning = true, troubles = emptyList())
        sensors.start()
    }

    /** Under the lock. */
    private fun rest() {
        if (!state.value.isRunning) return
        sensors.stop()
        state.value = PositioningStatus(isRunning = false, troubles = emptyList())
        // Ends the open step, so that the last fix is where the wearer stands.
        runCatching { positioner.flush() }
    }

    /** On the sensors' thread. */
    private fun push(batch: SampleBatch) {
        fresh.addAll(loop?.push(batch) ?: positioner.pushSamples(batch.bytes()))
    }

    /** Gives fixes to whoever reads, in order, without a lock: a reader may stop the session. */
    private fun handOn() {
        while (fresh.isNotEmpty() && isHandingOn.compareAndSet(false, true)) {
            try {
                generateSequence(fresh::poll).forEach { fix -> readers.forEach { it.take(fix) } }
            } finally {
                isHandingOn.set(false)
            }
        }
    }

    /** On the sensors' thread. */
    private fun report(troubles: List<Trouble>) {
        val engine = runCatching { positioner.status().missing.map(Trouble::of) }.getOrDefault(emptyList())
        val current = state.value
        // A word that comes late, after a stop, is dropped.
        if (current.isRunning) state.compareAndSet(current, current.copy(troubles = troubles + engine))
    }

    /** On the sensors' thread; they stop by themselves. */
    private fun fail(cause: Throwable) {
        failure = cause
        state.value = PositioningStatus(isRunning = false, troubles = emptyList())
        endReaders(cause)
    }

    private fun endReaders(cause: Throwable?) {
        readers.forEach { it.end(cause) }
        readers.clear()
    }
}
