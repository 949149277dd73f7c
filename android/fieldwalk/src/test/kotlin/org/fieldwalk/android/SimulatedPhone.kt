package org.fieldwalk.android

import android.Manifest.permission
import android.app.Application
import android.bluetooth.BluetoothManager
import android.bluetooth.le.ScanCallback
import android.bluetooth.le.ScanRecord
import android.bluetooth.le.ScanSettings
import android.content.Context
import android.content.Intent
import android.content.pm.PackageManager
import android.hardware.Sensor
import android.hardware.SensorManager
import android.location.LocationManager
import android.net.wifi.WifiManager
import android.os.SystemClock
import org.fieldwalk.Record
import org.robolectric.RuntimeEnvironment
import org.robolectric.Shadows.shadowOf
import org.robolectric.shadows.SensorEventBuilder
import org.robolectric.shadows.ShadowBluetoothDevice
import org.robolectric.shadows.ShadowLooper
import org.robolectric.shadows.ShadowSensor
import android.bluetooth.le.ScanResult as BleResult
import android.net.wifi.ScanResult as WifiRow

/** A phone whose sensors and radios say what a recording says, by Android's own callbacks. */
class SimulatedPhone(sensors: List<Int> = ALL_SENSORS) {
    val context: Application = RuntimeEnvironment.getApplication()
    private val sensorManager = shadowOf(context.getSystemService(Context.SENSOR_SERVICE) as SensorManager)
    private val bySensor = sensors.associateWith { ShadowSensor.newInstance(it) }
    private val adapter = context.getSystemService(BluetoothManager::class.java)!!.adapter
    private val wifi = context.getSystemService(WifiManager::class.java)

    init {
        bySensor.values.forEach(sensorManager::addSensor)
        shadowOf(context.packageManager).setSystemFeature(PackageManager.FEATURE_BLUETOOTH_LE, true)
        shadowOf(adapter).setState(android.bluetooth.BluetoothAdapter.STATE_ON)
        shadowOf(context.getSystemService(LocationManager::class.java)).setLocationEnabled(true)
    }

    fun grant(vararg names: String) = shadowOf(context).grantPermissions(*names)

    fun grantAll() = grant(permission.ACCESS_FINE_LOCATION, permission.ACCESS_COARSE_LOCATION, permission.BLUETOOTH_SCAN)

    fun deny(vararg names: String) = shadowOf(context).denyPermissions(*names)

    fun switchBluetooth(isOn: Boolean) {
        val state = if (isOn) android.bluetooth.BluetoothAdapter.STATE_ON else android.bluetooth.BluetoothAdapter.STATE_OFF
        shadowOf(adapter).setState(state)
        context.sendBroadcast(Intent("android.bluetooth.adapter.action.STATE_CHANGED"))
    }

    /** The switch of WiFi, and the one that lets apps scan all the same. */
    fun switchWifi(isOn: Boolean, isScanned: Boolean) {
        shadowOf(wifi).setWifiState(if (isOn) WifiManager.WIFI_STATE_ENABLED else WifiManager.WIFI_STATE_DISABLED)
        shadowOf(wifi).setIsScanAlwaysAvailable(isScanned)
    }

    /** Of Bluetooth, whoever began them. */
    val scans: Set<ScanCallback> get() = shadowOf(adapter.bluetoothLeScanner).scanCallbacks
    val nScans: Int get() = scans.size

    fun sensor(type: Int): Sensor = bySensor.getValue(type)

    /** Moves the clock, never back, and lets every thread do what was due by then. */
    fun clockTo(timeNs: Long) {
        val ms = Math.floorDiv(timeNs, 1_000_000L)
        if (ms > SystemClock.uptimeMillis()) SystemClock.setCurrentTimeMillis(ms)
    }

    fun pass(ms: Long) {
        SystemClock.setCurrentTimeMillis(SystemClock.uptimeMillis() + ms)
        settle()
    }

    /** Waits until every thread has done what is due. */
    fun settle() {
        repeat(2) {
            ShadowLooper.shadowMainLooper().idle()
            // A looper that has quit since refuses.
            for (looper in ShadowLooper.getAllLoopers().filter { "fieldwalk-" in it.thread.name && it.thread.isAlive }) {
                runCatching { shadowOf(looper).idle() }
            }
        }
    }

    /** Delivers a sample as the phone would; waypoints are no samples. */
    fun deliver(record: Record) {
        clockTo(record.timeNs)
        when (record.kind) {
            "specific_force" -> sense(Sensor.TYPE_ACCELEROMETER, record, 3)
            "angular_rate" -> sense(Sensor.TYPE_GYROSCOPE, record, 3)
            "magnetic_field" -> sense(Sensor.TYPE_MAGNETIC_FIELD, record, 3)
            "uncalibrated_magnetic_field" -> sense(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED, record, 6)
            "pressure" -> sense(Sensor.TYPE_PRESSURE, record, 1)
            "ble_sighting" -> hear(record, record.bytes(3), ibeacon(ByteArray(16), 0, 0))
            "ibeacon_sighting" -> {
                val (major, minor) = record.int(4) to record.int(5)
                hear(record, byteArrayOf(2, 0, 0, 0, minor.toByte(), major.toByte()), ibeacon(record.bytes(3), major, minor))
            }
            "wifi_sighting" -> hearWifi(listOf(record))
            else -> error("a phone has no ${record.kind}")
        }
    }

    fun sense(type: Int, timeNs: Long, vararg values: Float) {
        val sensor = bySensor[type] ?: return
        val event = SensorEventBuilder.newBuilder().setSensor(sensor).setTimestamp(timeNs).setValues(values).build()
        sensorManager.sendSensorEventToListeners(event, sensor)
    }

    fun hearWifi(records: List<Record>) {
        val rows = records.map { record ->
            WifiRow().also {
                it.BSSID = record.bytes(3).joinToString(":") { byte -> "%02x".format(byte) }
                it.level = record.float(2).toInt()
                it.timestamp = record.timeNs / 1_000
            }
        }
        shadowOf(wifi).setScanResults(rows)
        context.sendBroadcast(Intent(WifiManager.SCAN_RESULTS_AVAILABLE_ACTION))
        settle()
    }

    /** An advertisement, as Bluetooth gives it to whoever scans. */
    @Suppress("DEPRECATION")
    fun hearBle(timeNs: Long, rssiDbm: Int, address: ByteArray, advertisement: ByteArray) {
        val device = ShadowBluetoothDevice.newInstance(address.joinToString(":") { "%02X".format(it) })
        val result = BleResult(device, ScanRecord.parseFromBytes(advertisement), rssiDbm, timeNs)
        scans.forEach {
            it.onScanResult(ScanSettings.CALLBACK_TYPE_ALL_MATCHES, result)
        }
        settle()
    }

    private fun hear(record: Record, address: ByteArray, advertisement: ByteArray) =
        hearBle(record.timeNs, record.float(2).toInt(), address, advertisement)

    private fun sense(type: Int, record: Record, n: Int) =
        sense(type, record.timeNs, *FloatArray(n) { record.float(2 + it) })

    companion object {
        val ALL_SENSORS = listOf(
            Sensor.TYPE_ACCELEROMETER, Sensor.TYPE_GYROSCOPE, Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED,
            Sensor.TYPE_MAGNETIC_FIELD, Sensor.TYPE_PRESSURE,
        )

        fun ibeacon(uuid: ByteArray, major: Int, minor: Int): ByteArray =
            byteArrayOf(2, 1, 6, 0x1a, -1, 0x4c, 0, 2, 0x15) + uuid +
                byteArrayOf((major shr 8).toByte(), major.toByte(), (minor shr 8).toByte(), minor.toByte(), -59)
    }
}
