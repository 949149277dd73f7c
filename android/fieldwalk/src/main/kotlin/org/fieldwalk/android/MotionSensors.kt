package org.fieldwalk.android

import android.content.Context
import android.hardware.Sensor
import android.hardware.SensorEvent
import android.hardware.SensorEventListener
import android.hardware.SensorManager
import android.os.Build
import android.os.Handler

/** The phone's accelerometer, gyroscope, magnetometer and barometer. */
internal class MotionSensors(
    private val context: Context,
    private val sensing: Sensing,
    private val handler: Handler,
    private val run: SensorRun,
    /** Called when what [troubles] gives may have changed. */
    private val changed: () -> Unit,
) : SensorEventListener {
    private val sensors: SensorManager? = context.getSystemService(SensorManager::class.java)
    private val alignments = HashMap<Int, StampAlignment>()
    private var absent = emptyList<Trouble>()
    @Volatile private var heardNs = 0L
    @Volatile private var fieldAccuracy = SensorManager.SENSOR_STATUS_ACCURACY_HIGH

    fun start() {
        heardNs = SensorClock.nowNs()
        absent = listOfNotNull(
            missing(register(motionPeriodUs(), Sensor.TYPE_ACCELEROMETER), "accelerometer", "no step is seen"),
            missing(register(motionPeriodUs(), Sensor.TYPE_GYROSCOPE), "gyroscope", "turns are not seen"),
            // The raw field with its bias: when Android learns the bias anew, the engine is told so.
            missing(
                register(FIELD_PERIOD_US, Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, Sensor.TYPE_MAGNETIC_FIELD),
                "magnetometer", "the map's field cannot be compared",
            ),
        )
        if (sensing.pressure) register(PRESSURE_PERIOD_US, Sensor.TYPE_PRESSURE)
    }

    fun stop() {
        sensors?.unregisterListener(this)
    }

    fun troubles(): List<Trouble> {
        val unsure = fieldAccuracy == SensorManager.SENSOR_STATUS_UNRELIABLE ||
            fieldAccuracy == SensorManager.SENSOR_STATUS_ACCURACY_LOW
        val calibration = Trouble(
            TroubleKind.CALIBRATION,
            "the magnetometer says that it is not calibrated: the field weighs wrongly for the first metres",
            "swing the phone slowly in a figure of eight, away from metal",
        )
        return silence() + absent + if (unsure) listOf(calibration) else emptyList()
    }

    override fun onSensorChanged(event: SensorEvent) {
        val v = event.values
        val nowNs = SensorClock.nowNs()
        val timeNs = synchronized(alignments) { alignments.getOrPut(event.sensor.type, ::StampAlignment) }
            .aligned(event.timestamp, nowNs)
        if (event.sensor.type != Sensor.TYPE_PRESSURE) heardNs = nowNs
        when (event.sensor.type) {
            Sensor.TYPE_ACCELEROMETER -> run.take(timeNs) { specificForce(timeNs, v[0], v[1], v[2]) }
            Sensor.TYPE_GYROSCOPE -> run.take(timeNs) { angularRate(timeNs, v[0], v[1], v[2]) }
            Sensor.TYPE_MAGNETIC_FIELD -> run.take(timeNs) { magneticField(timeNs, v[0], v[1], v[2]) }
            Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED ->
                run.take(timeNs) { uncalibratedMagneticField(timeNs, v[0], v[1], v[2], v[3], v[4], v[5]) }
            Sensor.TYPE_PRESSURE -> run.take(timeNs) { pressure(timeNs, v[0]) }
        }
    }

    override fun onAccuracyChanged(sensor: Sensor, accuracy: Int) {
        val isField = sensor.type == Sensor.TYPE_MAGNETIC_FIELD || sensor.type == Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED
        if (isField && accuracy != fieldAccuracy) {
            fieldAccuracy = accuracy
            changed()
        }
    }

    /** Registers the first of [types] that the device has; false when it has none. */
    private fun register(periodUs: Int, vararg types: Int): Boolean = types.any { type ->
        val sensor = sensors?.getDefaultSensor(type) ?: return@any false
        val latencyUs = 1_000 * sensing.latencyMs.coerceIn(0, SensorRun.MAX_LATENCY_MS)
        sensors.registerListener(this, sensor, periodUs, latencyUs, handler)
    }

    /** The engine tells of a sensor that falls silent beside others; when all do, it hears nothing to tell the time by. */
    private fun silence(): List<Trouble> =
        if (absent.size == N_SENSORS || SensorClock.nowNs() - heardNs <= SILENT_NS) emptyList()
        else listOf(
            Trouble(
                TroubleKind.SENSORS_SILENT, "all motion sensors are silent: no step is seen, and the position stands still",
                "ask the user to switch the sensors on in the quick settings; while the app is not on the screen run " +
                    "PositioningService",
            ),
        )

    private fun missing(isRegistered: Boolean, sensor: String, consequence: String): Trouble? =
        if (isRegistered) null
        else Trouble(
            TroubleKind.SENSOR_ABSENT, "this device has no $sensor: $consequence",
            "use a device that has one; positions here are less sure",
        )

    private fun motionPeriodUs(): Int {
        // Since Android 12 a shorter period throws without the permission.
        val isFree = Build.VERSION.SDK_INT < Build.VERSION_CODES.S ||
            Permissions.isGranted(context, "android.permission.HIGH_SAMPLING_RATE_SENSORS")
        val fastestHz = if (isFree) FASTEST_HZ else FASTEST_FREE_HZ
        return 1_000_000 / sensing.motionHz.coerceIn(SLOWEST_HZ, fastestHz)
    }

    private companion object {
        const val SLOWEST_HZ = 50
        const val FASTEST_FREE_HZ = 200
        const val FASTEST_HZ = 400
        const val FIELD_PERIOD_US = 20_000
        const val PRESSURE_PERIOD_US = 200_000

        /** Accelerometer, gyroscope, magnetometer. */
        const val N_SENSORS = 3
        /** As the engine has it for each of them. */
        const val SILENT_NS = 5_000_000_000L
    }
}
