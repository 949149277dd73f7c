package org.fieldwalk.android

import android.Manifest.permission
import android.annotation.SuppressLint
import android.app.Notification
import android.app.Service
import android.content.Context
import android.content.Intent
import android.content.pm.ServiceInfo
import android.os.Build
import android.os.IBinder
import android.os.PowerManager

/**
 * Follows the wearer while another app is on the screen, or none: a foreground service of the type `location`, with the
 * app's notification.
 *
 * ```kotlin
 * PositioningService.begin(context, session, notification)?.let { trouble -> show(trouble.remedy) }
 * ```
 *
 * Sensors that do not wake the processor stand still while it sleeps, so it is kept awake until [end]. [begin] and [end]
 * may follow each other in any order, also before Android has started or ended the service.
 */
class PositioningService : Service() {
    private var wakeLock: PowerManager.WakeLock? = null
    /** What this service runs; [wanted] may be the next one's already. */
    private var running: Wanted? = null

    override fun onBind(intent: Intent?): IBinder? = null

    override fun onStartCommand(intent: Intent?, flags: Int, startId: Int): Int {
        val number = intent?.getIntExtra(NUMBER, 0)
        val wanted = synchronized(lock) { wanted?.also { if (it.number == number) it.isPending = false } }
        if (wanted == null) {
            stopSelf(startId)
        } else if (wanted.number == number) {
            // Owed to Android for every start, also for one that nobody wants any more.
            showNotification(wanted.notification)
            if (wanted.isOver || !run(wanted)) stopSelf(startId)
        }
        // Otherwise a later start is on its way. Android would start a sticky service anew without a session.
        return START_NOT_STICKY
    }

    override fun onDestroy() {
        running?.session?.stop()
        // One that is pending is for the next service.
        synchronized(lock) { if (wanted?.isPending == false) wanted = null }
        running = null
        wakeLock?.takeIf { it.isHeld }?.release()
        wakeLock = null
        super.onDestroy()
    }

    private fun showNotification(notification: Notification) {
        if (Build.VERSION.SDK_INT >= Build.VERSION_CODES.Q) {
            startForeground(NOTIFICATION_ID, notification, ServiceInfo.FOREGROUND_SERVICE_TYPE_LOCATION)
        } else {
            startForeground(NOTIFICATION_ID, notification)
        }
    }

    /** Ends another session and runs this one; false when it is closed. */
    @SuppressLint("WakelockTimeout") // As long as the wearer is to be followed; ends with the service.
    private fun run(wanted: Wanted): Boolean {
        running?.session?.takeIf { it !== wanted.session }?.stop()
        running = wanted
        if (!wanted.session.startUnlessClosed()) return false
        if (wakeLock == null) {
            val power = getSystemService(PowerManager::class.java)
            wakeLock = power?.newWakeLock(PowerManager.PARTIAL_WAKE_LOCK, "fieldwalk:positioning")?.also { it.acquire() }
        }
        return true
    }

    /** What a [begin] asked for; its number is in the intent, since Android delivers starts later. */
    private class Wanted(val number: Int, val session: PositioningSession, val notification: Notification) {
        /** Guarded by [lock]: whether Android has not delivered the start yet. */
        var isPending = true
        /** Whether [end] came before that. */
        var isOver = false
    }

    companion object {
        /** The number under which the notification is shown. */
        const val NOTIFICATION_ID = 0x4657

        private const val NUMBER = "org.fieldwalk.android.NUMBER"
        private val lock = Any()

        /** Guarded by [lock]. */
        private var nBegun = 0
        private var wanted: Wanted? = null

        /**
         * Runs [session] in the foreground service, in place of one that runs there; called while the app is on the
         * screen. Gives what is in the way, and has done nothing then. Of a closed session the service ends by itself.
         *
         * @param notification the app's own, of a channel that it has made
         */
        fun begin(context: Context, session: PositioningSession, notification: Notification): Trouble? {
            // Android 14 throws when a service of this type starts without the permission.
            if (!Permissions.isGranted(context, permission.ACCESS_FINE_LOCATION)) return Permissions.locationTrouble(context)
            synchronized(lock) {
                val next = Wanted(++nBegun, session, notification)
                // Throws when the app is not on the screen; what runs goes on then.
                val intent = Intent(context, PositioningService::class.java)
                context.startForegroundService(intent.putExtra(NUMBER, next.number))
                wanted = next
            }
            return null
        }

        /** Stops the service and its session; nothing happens when none runs. */
        fun end(context: Context): Unit = synchronized(lock) {
            val last = wanted
            if (last?.isPending == true) {
                // Android ends an app that stops the service before it has shown the notification it owes.
                last.isOver = true
            } else {
                context.stopService(Intent(context, PositioningService::class.java))
            }
        }
    }
}
