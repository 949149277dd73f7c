package org.fieldwalk.android

import android.bluetooth.le.ScanFilter
import android.bluetooth.le.ScanResult
import android.bluetooth.le.ScanSettings
import android.content.Context
import kotlinx.coroutines.channels.BufferOverflow
import kotlinx.coroutines.channels.awaitClose
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.buffer
import kotlinx.coroutines.flow.callbackFlow
import java.util.concurrent.CopyOnWriteArraySet

/** Cards near the phone. What a card says is of its wearer, not of the phone's: it goes to a positioner of its own. */
class CardScanner(context: Context) {
    private val context = context.applicationContext
    private val scans = CopyOnWriteArraySet<KeptScan>()

    /** What keeps cards from being heard. */
    fun trouble(): Trouble? = BluetoothTrouble.of(context) ?: scans.firstNotNullOfOrNull { it.trouble() }

    /**
     * Every frame heard, while the flow is collected; none while [trouble] names something, again once it is mended.
     */
    fun sightings(): Flow<CardSighting> = callbackFlow {
        lateinit var scan: KeptScan
        val watch = SwitchWatch(context, "fieldwalk-cards") { scan.advance() }
        scan = KeptScan(context, CARDS, ScanSettings.SCAN_MODE_LOW_LATENCY, watch.handler) { result ->
            CardSighting.of(result)?.let { trySend(it) }
        }
        scans.add(scan)
        scan.advance()
        watch.begin()
        awaitClose {
            watch.end()
            scan.end()
            scans.remove(scan)
        }
    }.buffer(256, BufferOverflow.DROP_OLDEST)

    private companion object {
        val CARDS: ScanFilter = ScanFilter.Builder().setManufacturerData(CardSighting.COMPANY, byteArrayOf()).build()
    }
}

/** A card heard over Bluetooth. */
class CardSighting(
    /** When, on [SensorClock]. */
    val timeNs: Long,
    /** Received signal strength, in dBm. */
    val rssiDbm: Float,
    /** The card's frame as it is on the air, 31 bytes. */
    val frame: ByteArray,
) {
    companion object {
        private const val FRAME_BYTES = 31

        /** Set aside for tests by the Bluetooth SIG. */
        internal const val COMPANY = 0xFFFF
        private val HEAD = byteArrayOf(0x02, 0x01, 0x06, 0x1b, -1, -1, -1)

        /** A sighting of what Android heard; null when it is no card's. */
        internal fun of(result: ScanResult): CardSighting? {
            val bytes = result.scanRecord?.bytes ?: return null
            // Android pads a record to 62 bytes.
            if (bytes.size < FRAME_BYTES || HEAD.indices.any { bytes[it] != HEAD[it] }) return null
            return CardSighting(result.timestampNanos, result.rssi.toFloat(), bytes.copyOf(FRAME_BYTES))
        }
    }
}
