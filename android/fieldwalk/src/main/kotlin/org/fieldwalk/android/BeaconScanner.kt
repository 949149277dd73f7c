package org.fieldwalk.android

import android.annotation.SuppressLint
import android.bluetooth.BluetoothManager
import android.bluetooth.le.BluetoothLeScanner
import android.bluetooth.le.ScanCallback
import android.bluetooth.le.ScanFilter
import android.bluetooth.le.ScanResult
import android.bluetooth.le.ScanSettings
import android.content.Context
import android.os.Handler
import android.os.SystemClock
import org.fieldwalk.ApiException
import org.fieldwalk.SampleBatch
import org.fieldwalk.decodeIbeaconManufacturerData
import java.nio.ByteBuffer

/** iBeacons, heard over Bluetooth. */
internal class BeaconScanner(
    private val context: Context,
    private val use: RadioUse,
    mapUuids: List<ByteArray>,
    private val handler: Handler,
    private val run: SensorRun,
) {
    /** Those by which the map knows its beacons; all others it knows by their address. */
    private val mapUuids: Set<ByteBuffer> = mapUuids.map(ByteBuffer::wrap).toSet()
    private var scanner: BluetoothLeScanner? = null
    private var startedMs = 0L
    private var failure: Trouble? = null

    private val callback = object : ScanCallback() {
        // Android calls on the main thread, which has other things to do.
        override fun onScanResult(callbackType: Int, result: ScanResult) {
            val nowNs = SensorClock.nowNs()
            handler.post { take(result, nowNs) }
        }

        override fun onScanFailed(errorCode: Int) {
            handler.post { fail("Android refused to scan for beacons, error $errorCode") }
        }
    }

    /** Begins to scan, or goes on, when nothing is in its way; called again and again. */
    @SuppressLint("MissingPermission") // BluetoothTrouble looks for it.
    fun advance() {
        if (use == RadioUse.OFF) return
        if (BluetoothTrouble.of(context) != null) return stop()
        val nowMs = SystemClock.elapsedRealtime()
        if (scanner != null) {
            // After half an hour Android turns a scan into one that hears only what others scan for.
            if (nowMs - startedMs < RENEWED_AFTER_MS) return
            stop()
        }
        if (!budget.let { synchronized(it) { it.take(nowMs) } }) return
        val scanner = context.getSystemService(BluetoothManager::class.java)?.adapter?.bluetoothLeScanner ?: return
        val settings = ScanSettings.Builder().setScanMode(scanMode()).setReportDelay(0).build()
        try {
            scanner.startScan(listOf(IBEACONS), settings, callback)
            this.scanner = scanner
            startedMs = nowMs
            failure = null
        } catch (refused: SecurityException) {
            fail("Android refused to scan for beacons: ${refused.message}")
        } catch (off: IllegalStateException) {
            fail("Bluetooth was switched off a moment ago")
        }
    }

    @SuppressLint("MissingPermission")
    fun stop() {
        // Bluetooth may be off, or the permission taken back, and then the scan is over by itself.
        try {
            scanner?.stopScan(callback)
        } catch (_: SecurityException) {
        } catch (_: IllegalStateException) {
        }
        scanner = null
    }

    fun troubles(): List<Trouble> =
        if (use == RadioUse.OFF) emptyList() else listOfNotNull(BluetoothTrouble.of(context) ?: failure)

    private fun take(result: ScanResult, nowNs: Long) {
        val payload = result.scanRecord?.getManufacturerSpecificData(APPLE) ?: return
        val beacon = try {
            decodeIbeaconManufacturerData(APPLE.toUShort(), payload.toDirect())
        } catch (_: ApiException) {
            return
        }
        val timeNs = told(result.timestampNanos, nowNs)
        val rssiDbm = result.rssi.toFloat()
        run.take(timeNs) {
            if (ByteBuffer.wrap(beacon.uuid) in mapUuids) {
                ibeaconSighting(timeNs, rssiDbm, beacon.uuid, beacon.major.toInt(), beacon.minor.toInt())
            } else {
                addressed(timeNs, rssiDbm, result.device.address)
            }
        }
    }

    private fun SampleBatch.addressed(timeNs: Long, rssiDbm: Float, address: String) {
        addressBytes(address)?.let { bleSighting(timeNs, rssiDbm, it) }
    }

    private fun fail(explanation: String) {
        scanner = null
        failure = Trouble(
            TroubleKind.BLUETOOTH_FAILED, explanation, "switch Bluetooth off and on; if that does not help, restart the phone",
        )
    }

    private fun scanMode() = when (use) {
        RadioUse.CONTINUOUS -> ScanSettings.SCAN_MODE_LOW_LATENCY
        RadioUse.BALANCED -> ScanSettings.SCAN_MODE_BALANCED
        RadioUse.SPARING, RadioUse.OFF -> ScanSettings.SCAN_MODE_LOW_POWER
    }

    companion object {
        const val APPLE = 0x004C
        private const val RENEWED_AFTER_MS = 25 * 60 * 1_000L

        /** Android counts the starts of an app, not of an object; one is left to the app. */
        private val budget = ScanBudget(4, 30_000)

        /** With a filter Android keeps scanning while the screen is off. */
        private val IBEACONS = ScanFilter.Builder().setManufacturerData(APPLE, byteArrayOf(0x02, 0x15)).build()

        /** The six bytes of `AA:BB:CC:DD:EE:FF`. */
        fun addressBytes(address: String): ByteArray? {
            val bytes = address.split(':').mapNotNull { it.toIntOrNull(16)?.toByte() }
            return bytes.takeIf { it.size == 6 }?.toByteArray()
        }

        /**
         * The stamp to give what was heard at [heardNs] and told at [nowNs]: when it was heard, unless that is so long
         * ago that the engine would refuse it; a second's walk is little beside the reach of radio.
         */
        fun told(heardNs: Long, nowNs: Long): Long = if (heardNs in nowNs - FRESH_NS..nowNs) heardNs else nowNs

        /** Inside the engine's reorder window with a batch's latency. */
        private const val FRESH_NS = 100_000_000L
    }
}

/** A copy that the engine can read in place. */
internal fun ByteArray.toDirect(): ByteBuffer = ByteBuffer.allocateDirect(size).also {
    it.put(this)
    it.flip()
}
