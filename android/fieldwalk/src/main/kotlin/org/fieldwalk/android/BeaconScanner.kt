package org.fieldwalk.android

import android.bluetooth.le.ScanFilter
import android.bluetooth.le.ScanResult
import android.bluetooth.le.ScanSettings
import android.content.Context
import android.os.Handler
import org.fieldwalk.ApiException
import org.fieldwalk.SampleBatch
import org.fieldwalk.decodeIbeaconManufacturerData
import java.nio.ByteBuffer

/** iBeacons, heard over Bluetooth. */
internal class BeaconScanner(
    context: Context,
    use: RadioUse,
    mapUuids: List<ByteArray>,
    handler: Handler,
    private val run: SensorRun,
) {
    /** Those by which the map knows its beacons; all others it knows by their address. */
    private val mapUuids: Set<ByteBuffer> = mapUuids.map(ByteBuffer::wrap).toSet()
    private val scan = scanMode(use)?.let { mode ->
        KeptScan(context, IBEACONS, mode, handler) { result ->
            val nowNs = SensorClock.nowNs()
            handler.post { take(result, nowNs) }
        }
    }

    /** Begins to scan, or goes on, when nothing is in its way; called again and again. */
    fun advance() {
        scan?.advance()
    }

    fun end() {
        scan?.end()
    }

    fun troubles(): List<Trouble> = listOfNotNull(scan?.trouble())

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

    private fun scanMode(use: RadioUse): Int? = when (use) {
        RadioUse.CONTINUOUS -> ScanSettings.SCAN_MODE_LOW_LATENCY
        RadioUse.BALANCED -> ScanSettings.SCAN_MODE_BALANCED
        RadioUse.SPARING -> ScanSettings.SCAN_MODE_LOW_POWER
        RadioUse.OFF -> null
    }

    companion object {
        const val APPLE = 0x004C
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
