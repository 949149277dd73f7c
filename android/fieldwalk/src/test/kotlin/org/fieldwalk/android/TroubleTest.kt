package org.fieldwalk.android

import android.Manifest.permission
import android.content.Intent
import android.hardware.Sensor
import android.hardware.SensorManager
import android.location.LocationManager
import android.os.PowerManager
import org.fieldwalk.ApiException
import org.fieldwalk.BuildingMap
import org.fieldwalk.Walk
import org.junit.After
import org.junit.Assert.assertEquals
import org.junit.Assert.assertNotNull
import org.junit.Assert.assertThrows
import org.junit.Assert.assertTrue
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.RobolectricTestRunner
import org.robolectric.Shadows.shadowOf
import org.robolectric.annotation.Config
import java.io.File
import java.nio.file.Files

/** What is in the way is said, with a remedy, and mended without a new start. */
@RunWith(RobolectricTestRunner::class)
class TroubleTest {
    private var session: PositioningSession? = null

    @After
    fun close() {
        session?.close()
    }

    private fun begin(phone: SimulatedPhone, sensing: Sensing = Sensing()) = Walk.openMap().use { map ->
        Fieldwalk.positioner(phone.context, map, sensing = sensing).also {
            session = it
            it.start()
            phone.settle()
        }
    }

    private fun PositioningSession.kinds() = status.value.troubles.map { it.kind }.filter { it != TroubleKind.ENGINE }

    @Test
    fun `permissions that are denied and granted later`() {
        val phone = SimulatedPhone()
        val session = begin(phone)
        assertEquals(listOf(TroubleKind.BLUETOOTH_PERMISSION, TroubleKind.LOCATION_PERMISSION), session.kinds())
        assertEquals(listOf(permission.BLUETOOTH_SCAN), session.status.value.troubles[0].permissions)
        assertTrue(session.status.value.troubles.all { it.remedy.isNotEmpty() })
        assertEquals(0, phone.nScans)
        phone.grantAll()
        phone.pass(2_000)
        assertEquals(emptyList<TroubleKind>(), session.kinds())
        assertEquals(1, phone.nScans)
        // Taken back in the settings.
        phone.deny(permission.ACCESS_FINE_LOCATION)
        session.refresh()
        assertEquals(listOf(TroubleKind.LOCATION_PERMISSION), session.kinds())
        assertEquals(0, phone.nScans)
    }

    @Test
    @Config(sdk = [30])
    fun `before Android 12 the location is the only permission`() {
        val phone = SimulatedPhone()
        val session = begin(phone)
        assertEquals(listOf(TroubleKind.LOCATION_PERMISSION), session.kinds())
        assertEquals(Permissions.forWifi(), session.status.value.troubles[0].permissions)
        phone.grant(permission.ACCESS_FINE_LOCATION)
        phone.pass(2_000)
        assertEquals(emptyList<TroubleKind>(), session.kinds())
        assertEquals(1, phone.nScans)
    }

    @Test
    fun `Bluetooth and the location switched off and on`() {
        val phone = SimulatedPhone().also { it.grantAll() }
        val session = begin(phone)
        assertEquals(1, phone.nScans)
        phone.switchBluetooth(false)
        phone.settle()
        assertEquals(listOf(TroubleKind.BLUETOOTH_OFF), session.kinds())
        phone.switchBluetooth(true)
        phone.settle()
        assertEquals(emptyList<TroubleKind>(), session.kinds())
        assertEquals(1, phone.nScans)
        val location = shadowOf(phone.context.getSystemService(LocationManager::class.java))
        location.setLocationEnabled(false)
        phone.pass(2_000)
        assertEquals(listOf(TroubleKind.LOCATION_OFF), session.kinds())
        location.setLocationEnabled(true)
        phone.pass(2_000)
        assertEquals(emptyList<TroubleKind>(), session.kinds())
    }

    @Test
    fun `WiFi switched off and on, where the map has access points`() {
        val phone = SimulatedPhone().also { it.grantAll() }
        val session = begin(phone)
        assertEquals(emptyList<TroubleKind>(), session.kinds())
        fun afterSwitch(isOn: Boolean, isScanned: Boolean): List<TroubleKind> {
            phone.switchWifi(isOn, isScanned)
            phone.pass(1_000)
            return session.kinds()
        }
        assertEquals(listOf(TroubleKind.WIFI_OFF), afterSwitch(isOn = false, isScanned = false))
        assertEquals(emptyList<TroubleKind>(), afterSwitch(isOn = false, isScanned = true))
        assertEquals(listOf(TroubleKind.WIFI_OFF), afterSwitch(isOn = false, isScanned = false))
        assertEquals(emptyList<TroubleKind>(), afterSwitch(isOn = true, isScanned = false))
        // Without access points, and where WiFi is not wanted, there is nothing to switch on.
        phone.switchWifi(isOn = false, isScanned = false)
        fun nTroubles(wifi: Boolean, hasAccessPoints: Boolean): Int {
            var last = emptyList<Trouble>()
            val sensing = Sensing(wifi = wifi)
            val report = { troubles: List<Trouble> -> last = troubles }
            PhoneSensors(phone.context, sensing, hasAccessPoints = hasAccessPoints, push = {}, report = report).run {
                start()
                stop()
            }
            return last.size
        }
        assertEquals(listOf(1, 0, 0), listOf(nTroubles(true, true), nTroubles(true, false), nTroubles(false, true)))
    }

    @Test
    fun `radio that is not wanted needs no permission`() {
        val phone = SimulatedPhone()
        val session = begin(phone, Sensing(beacons = RadioUse.OFF, wifi = false))
        assertEquals(emptyList<TroubleKind>(), session.kinds())
    }

    @Test
    fun `sensors that the device has not`() {
        val phone = SimulatedPhone(listOf(Sensor.TYPE_ACCELEROMETER, Sensor.TYPE_MAGNETIC_FIELD)).also { it.grantAll() }
        val session = begin(phone, Sensing(latencyMs = 0))
        assertEquals(listOf(TroubleKind.SENSOR_ABSENT), session.kinds())
        assertTrue(session.status.value.troubles[0].explanation.contains("gyroscope"))
        // The calibrated field stands in for the raw one.
        val timeNs = SensorClock.nowNs()
        phone.sense(Sensor.TYPE_ACCELEROMETER, timeNs, 0f, 0f, 9.81f)
        phone.sense(Sensor.TYPE_MAGNETIC_FIELD, timeNs, 20f, 0f, -40f)
        val missing = session.engineStatus().missing.map { it.what.name }
        assertEquals(listOf("GYROSCOPE"), missing.filter { it == "GYROSCOPE" || it == "MAGNETOMETER" })
    }

    @Test
    fun `sensors that all fall silent, as when they are switched off, and speak again`() {
        val phone = SimulatedPhone().also { it.grantAll() }
        val session = begin(phone)
        fun speak() = phone.sense(Sensor.TYPE_GYROSCOPE, SensorClock.nowNs(), 0f, 0f, 0f)
        repeat(7) {
            phone.pass(1_000)
            speak()
        }
        assertEquals(emptyList<TroubleKind>(), session.kinds())
        phone.pass(4_900)
        assertEquals(emptyList<TroubleKind>(), session.kinds())
        repeat(2) {
            phone.pass(1_000)
            // Air pressure is no motion.
            phone.sense(Sensor.TYPE_PRESSURE, SensorClock.nowNs(), 1_000f)
        }
        assertEquals(listOf(TroubleKind.SENSORS_SILENT), session.kinds())
        assertTrue(session.status.value.isRunning)
        speak()
        phone.pass(1_000)
        assertEquals(emptyList<TroubleKind>(), session.kinds())
        // Never heard since the start.
        session.stop()
        phone.pass(60_000)
        session.start()
        phone.settle()
        assertEquals(emptyList<TroubleKind>(), session.kinds())
        phone.pass(6_000)
        assertEquals(listOf(TroubleKind.SENSORS_SILENT), session.kinds())
    }

    @Test
    fun `a magnetometer that mistrusts itself`() {
        val phone = SimulatedPhone().also { it.grantAll() }
        val told = mutableListOf<List<Trouble>>()
        val sensors = PhoneSensors(phone.context, push = {}, report = { synchronized(told) { told.add(it) } })
        sensors.start()
        val listener = shadowOf(phone.context.getSystemService(SensorManager::class.java)).listeners
            .single { it is MotionSensors }
        val field = phone.sensor(Sensor.TYPE_MAGNETIC_FIELD_UNCALIBRATED)
        for (accuracy in listOf(SensorManager.SENSOR_STATUS_UNRELIABLE, SensorManager.SENSOR_STATUS_ACCURACY_HIGH)) {
            listener.onAccuracyChanged(field, accuracy)
            phone.settle()
        }
        sensors.stop()
        val kinds = synchronized(told) { told.map { troubles -> troubles.map { it.kind } } }
        assertEquals(listOf(emptyList(), listOf(TroubleKind.CALIBRATION), emptyList()), kinds.distinctRuns())
    }

    @Test
    fun `a doze is told, and a hint after it positions anew`() {
        val phone = SimulatedPhone().also { it.grantAll() }
        val session = begin(phone)
        val power = shadowOf(phone.context.getSystemService(PowerManager::class.java))
        for (isDozing in listOf(true, false)) {
            power.setIsDeviceIdleMode(isDozing)
            phone.context.sendBroadcast(Intent(PowerManager.ACTION_DEVICE_IDLE_MODE_CHANGED))
            phone.settle()
            assertEquals(isDozing, TroubleKind.DOZING in session.kinds())
        }
    }

    @Test
    fun `a map that is not one`() {
        val folder = Files.createTempDirectory("map").toFile()
        Walk.mapFolder.copyRecursively(folder, overwrite = true)
        val floor = folder.walk().first { it.extension == "safetensors" }
        val bytes = floor.readBytes()
        bytes[bytes.size - 7] = (bytes[bytes.size - 7] + 1).toByte()
        floor.writeBytes(bytes)
        val corrupt = assertThrows(ApiException.MapCorrupt::class.java) { BuildingMap.open(folder.path) }
        val trouble = Trouble.of(corrupt)
        assertEquals(TroubleKind.MAP, trouble.kind)
        assertTrue(trouble.explanation.isNotEmpty() && trouble.remedy.isNotEmpty())
        val absent = assertThrows(ApiException.MapNotFound::class.java) { BuildingMap.open(File(folder, "none").path) }
        assertNotNull(Trouble.of(absent).remedy)
        folder.deleteRecursively()
    }

    /** Without what repeats the one before. */
    private fun <T> List<T>.distinctRuns() = filterIndexed { k, item -> k == 0 || item != this[k - 1] }
}
