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

/** A Bluetooth scan that is kept going: begun when nothing is in its way, renewed, and begun again after a failure. */
internal class KeptScan(
    private val context: Context,
    /** With one Android keeps scanning while the screen is off. */
    private val filter: ScanFilter,
    private val mode: Int,
    /** Where a failure that Android tells is noted. */
    private val handler: Handler,
    /** Called on the main thread, which has other things to do. */
    private val heard: (ScanResult) -> Unit,
) {
    @Volatile private var running: Listener? = null
    private var isEnded = false
    private var startedMs = 0L
    private var failure: Trouble? = null

    /** A new one for every start: Android refuses one that listens still, as when it could not be stopped. */
    private inner class Listener(val scanner: BluetoothLeScanner) : ScanCallback() {
        override fun onScanResult(callbackType: Int, result: ScanResult) {
            if (running === this) heard(result)
        }

        override fun onScanFailed(errorCode: Int) {
            handler.post { failed(this, errorCode) }
        }
    }

    /** Begins to scan, or goes on; called again and again. */
    @Synchronized
    fun advance() {
        if (isEnded) return
        if (BluetoothTrouble.of(context) != null) {
            failure = null
            return stop()
        }
        val nowMs = SystemClock.elapsedRealtime()
        if (running != null) {
            // Android would have told a failure since the last call.
            failure = null
            if (nowMs - startedMs < RENEWED_AFTER_MS) return
        }
        // One that is due to be renewed goes on until there is a start left.
        if (!budget.let { synchronized(it) { it.take(nowMs) } }) return
        stop()
        begin(nowMs)
    }

    /** Stops for good, also when [advance] is on its way. */
    @Synchronized
    fun end() {
        isEnded = true
        stop()
    }

    /** What keeps it from hearing, now or when it was begun last. */
    @Synchronized
    fun trouble(): Trouble? = BluetoothTrouble.of(context) ?: failure

    @SuppressLint("MissingPermission")
    private fun stop() {
        // Bluetooth may be off, or the permission taken back, and then the scan is over by itself.
        try {
            running?.let { it.scanner.stopScan(it) }
        } catch (_: SecurityException) {
        } catch (_: IllegalStateException) {
        }
        running = null
    }

    @SuppressLint("MissingPermission") // BluetoothTrouble looks for it.
    private fun begin(nowMs: Long) {
        val scanner = context.getSystemService(BluetoothManager::class.java)?.adapter?.bluetoothLeScanner ?: return
        val settings = ScanSettings.Builder().setScanMode(mode).setReportDelay(0).build()
        val listener = Listener(scanner)
        try {
            // Before: Android may tell at once.
            running = listener
            startedMs = nowMs
            scanner.startScan(listOf(filter), settings, listener)
        } catch (refused: SecurityException) {
            fail("Android refused to scan: ${refused.message}")
        } catch (off: IllegalStateException) {
            fail("Bluetooth was switched off a moment ago")
        }
    }

    @Synchronized
    private fun failed(listener: Listener, errorCode: Int) {
        if (running === listener) fail("Android refused to scan, error $errorCode")
    }

    private fun fail(explanation: String) {
        stop()
        failure = Trouble(
            TroubleKind.BLUETOOTH_FAILED, "$explanation: nothing is heard",
            "switch Bluetooth off and on; if that does not help, restart the phone",
        )
    }

    private companion object {
        /** Newer Androids turn a scan down to a tenth after ten minutes, older ones to nothing after thirty. */
        const val RENEWED_AFTER_MS = 9 * 60 * 1_000L

        /** Android counts the starts of an app, not of an object; one is left to the app. */
        val budget = ScanBudget(4, 30_000)
    }
}
