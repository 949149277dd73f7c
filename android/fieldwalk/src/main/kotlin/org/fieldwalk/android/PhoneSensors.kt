package org.fieldwalk.android

import android.content.Context
import android.os.PowerManager
import org.fieldwalk.BuildingMap
import java.nio.ByteBuffer

/**
 * The phone's sensors and radios on a thread of their own, packed into batches.
 *
 * A positioner has its own; this is for apps that survey or record. [start] and [stop] may be called from any thread, any
 * number of times.
 */
class PhoneSensors internal constructor(
    context: Context,
    private val sensing: Sensing,
    private val ibeaconUuids: List<ByteArray>,
    private val hasAccessPoints: Boolean,
    private val sink: BatchSink,
    private val pushed: () -> Unit,
    private val report: (List<Trouble>) -> Unit,
    private val fail: (Throwable) -> Unit,
) {
    /**
     * @param ibeaconUuids by which a map knows its beacons, [BuildingMap.ibeaconUuids]; all others are known by their address
     * @param hasAccessPoints whether a map has some, [BuildingMap.hasAccessPoints], or a survey looks for some: only then
     *   it is told that WiFi is switched off
     * @param push takes a batch, valid during the call only, on the thread of the sensors; one that throws ends the sensors; it
     *   must not call this object
     * @param pushed called after every batch, free to call anything
     * @param report called every second and at every change with what is in the way, on the thread of the sensors
     * @param fail called once with what [push] threw
     */
    constructor(
        context: Context,
        sensing: Sensing = Sensing(),
        ibeaconUuids: List<ByteArray> = emptyList(),
        hasAccessPoints: Boolean = true,
        push: (ByteBuffer) -> Unit,
        pushed: () -> Unit = {},
        report: (List<Trouble>) -> Unit = {},
        fail: (Throwable) -> Unit = {},
    ) : this(context, sensing, ibeaconUuids, hasAccessPoints, BatchSink { push(it.bytes()) }, pushed, report, fail)

    private val context = context.applicationContext
    private var session: Session? = null

    /** Starts what is not started; what is in the way is told to `report` and tried again every second. */
    @Synchronized
    fun start() {
        if (session == null) session = Session().also { it.begin() }
    }

    /** Pushes what was sensed and not pushed yet. */
    @Synchronized
    fun flush() {
        session?.run?.flush()
    }

    /** Looks anew at permissions and switches; for `onResume`, otherwise it happens every second. */
    @Synchronized
    fun refresh() {
        session?.look()
    }

    /** Pushes what was sensed, and stops. */
    @Synchronized
    fun stop() {
        session?.end()
        session = null
    }

    /** From a start to its stop. */
    private inner class Session {
        val run = SensorRun(sensing.latencyMs, sink, pushed, ::end)
        private val watch = SwitchWatch(context, "fieldwalk-sensors") {
            run.flush()
            look()
        }
        private val motion = MotionSensors(context, sensing, watch.handler, run, watch::lookSoon)
        private val beacons = BeaconScanner(context, sensing.beacons, ibeaconUuids, watch.handler, run)
        private val wifi = if (sensing.wifi) WifiScanner(context, hasAccessPoints, watch.handler, run) else null
        private var isEnded = false

        fun begin() {
            watch.begin()
            motion.start()
            look()
        }

        /** Tries what is not running, and tells what is in the way. */
        fun look() = advanced()?.let(report) ?: Unit

        @Synchronized
        private fun advanced(): List<Trouble>? {
            if (isEnded) return null
            beacons.advance()
            wifi?.advance()
            return (motion.troubles() + beacons.troubles() + wifi?.troubles().orEmpty() + dozing()).distinct()
        }

        /** Under the lock of the run, which [end] needs too. */
        private fun end(failure: Throwable) {
            watch.handler.post(::stop)
            fail(failure)
        }

        @Synchronized
        fun end() {
            isEnded = true
            motion.stop()
            beacons.end()
            wifi?.stop()
            run.end()
            watch.end()
        }

        private fun dozing(): List<Trouble> =
            if (context.getSystemService(PowerManager::class.java)?.isDeviceIdleMode != true) emptyList()
            else listOf(
                Trouble(
                    TroubleKind.DOZING, "the device dozes: sensors stand still",
                    "run in the foreground service to be followed with the screen off; after a long doze give a hint",
                ),
            )
    }
}
