package org.fieldwalk.android

import android.annotation.SuppressLint
import android.content.BroadcastReceiver
import android.content.Context
import android.content.Intent
import android.net.wifi.ScanResult
import android.net.wifi.WifiManager
import android.os.Handler
import android.os.SystemClock

/** WiFi access points, scanned as often as Android allows. */
internal class WifiScanner(
    private val context: Context,
    /** Whether there is something to hear: otherwise it is no trouble that WiFi is off. */
    private val hasAccessPoints: Boolean,
    private val handler: Handler,
    private val run: SensorRun,
) {
    private val wifi: WifiManager? = context.getSystemService(WifiManager::class.java)
    private var isListening = false
    /** When each access point was heard last, in µs: Android repeats old rows. */
    private val heardUs = HashMap<String, Long>()

    private val receiver = object : BroadcastReceiver() {
        override fun onReceive(context: Context, intent: Intent) = take()
    }

    /** Asks for a scan when Android would answer; called again and again. */
    fun advance() {
        if (wifi == null || Permissions.locationTrouble(context) != null) return
        if (!isListening) {
            context.listen(receiver, listOf(WifiManager.SCAN_RESULTS_AVAILABLE_ACTION), handler)
            isListening = true
        }
        if (synchronized(budget) { budget.take(SystemClock.elapsedRealtime()) }) {
            // Deprecated for want of a better one; in vain when the app is not on the screen.
            @Suppress("DEPRECATION") wifi.startScan()
        }
    }

    fun stop() {
        if (isListening) context.unregisterReceiver(receiver)
        isListening = false
    }

    fun troubles(): List<Trouble> = listOfNotNull(Permissions.locationTrouble(context), switchTrouble())

    private fun switchTrouble(): Trouble? {
        // Apps may be let scan while WiFi is switched off, by a switch of the location's settings.
        @Suppress("DEPRECATION")
        val isHeard = wifi == null || wifi.isWifiEnabled || wifi.isScanAlwaysAvailable
        if (isHeard || !hasAccessPoints) return null
        return Trouble(
            TroubleKind.WIFI_OFF, "WiFi is switched off: no access point is heard",
            "ask the user to switch WiFi on, or scans for WiFi in the location's settings",
        )
    }

    @SuppressLint("MissingPermission") // locationTrouble looked for it; a row less when it is taken back meanwhile.
    private fun take() {
        val rows = try {
            wifi?.scanResults.orEmpty()
        } catch (_: SecurityException) {
            emptyList()
        }
        val nowNs = SensorClock.nowNs()
        val isFresh = { timeUs: Long -> nowNs / 1_000 - timeUs in 0..STALE_US }
        heardUs.values.removeIf { !isFresh(it) }
        for (row in rows.filter { isFresh(it.timestamp) }) take(row, nowNs)
    }

    private fun take(row: ScanResult, nowNs: Long) {
        @Suppress("DEPRECATION") val name = row.BSSID ?: return
        val bssid = BeaconScanner.addressBytes(name) ?: return
        val beforeUs = heardUs.put(name, row.timestamp)
        if (beforeUs != null && beforeUs >= row.timestamp) return
        // A scan lasts seconds, and the engine refuses what is so late.
        val timeNs = BeaconScanner.told(row.timestamp * 1_000, nowNs)
        run.take(timeNs) { wifiSighting(timeNs, row.level.toFloat(), bssid) }
    }

    companion object {
        /** Rows older than this are of another place. */
        private const val STALE_US = 5_000_000L

        /** Spread evenly: one in 30 s. */
        private val budget = ScanBudget(1, 30_000)
    }
}
