package org.fieldwalk.android

import android.content.BroadcastReceiver
import android.content.Context
import android.content.Intent
import android.content.IntentFilter
import android.os.Build
import android.os.Handler
import android.os.HandlerThread
import android.os.PowerManager
import android.os.Process

/** Looks every second, and when a switch is thrown, whether something is in the way; on a thread of its own. */
internal class SwitchWatch(private val context: Context, threadName: String, private val look: () -> Unit) {
    private val thread = HandlerThread(threadName, Process.THREAD_PRIORITY_MORE_FAVORABLE).also { it.start() }
    val handler = Handler(thread.looper)

    private val switches = object : BroadcastReceiver() {
        override fun onReceive(context: Context, intent: Intent) = lookSoon()
    }
    private val tick = object : Runnable {
        override fun run() {
            look()
            handler.postDelayed(this, TICK_MS)
        }
    }

    fun begin() {
        context.listen(switches, SWITCHES, handler)
        handler.postDelayed(tick, TICK_MS)
    }

    fun lookSoon() {
        handler.post(look)
    }

    fun end() {
        context.unregisterReceiver(switches)
        thread.quitSafely()
    }

    private companion object {
        const val TICK_MS = 1_000L
        val SWITCHES = listOf(
            "android.bluetooth.adapter.action.STATE_CHANGED",
            "android.location.MODE_CHANGED",
            PowerManager.ACTION_DEVICE_IDLE_MODE_CHANGED,
        )
    }
}

/** Registers for what only the system sends. */
internal fun Context.listen(receiver: BroadcastReceiver, actions: List<String>, handler: Handler) {
    val filter = IntentFilter()
    actions.forEach(filter::addAction)
    if (Build.VERSION.SDK_INT >= Build.VERSION_CODES.TIRAMISU) {
        registerReceiver(receiver, filter, null, handler, Context.RECEIVER_NOT_EXPORTED)
    } else {
        registerReceiver(receiver, filter, null, handler)
    }
}
