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
 * Sensors that do not wake the processor stand still while it sleeps, so it is kept awake until [end].
 */
class PositioningService : Service() {
    private var wakeLock: PowerManager.WakeLock? = null

    override fun onBind(intent: Intent?): IBinder? = null

    @SuppressLint("WakelockTimeout") // As long as the wearer is to be followed; ends with the service.
    override fun onStartCommand(intent: Intent?, flags: Int, startId: Int): Int {
        val (session, notification) = wanted ?: run {
            stopSelf()
            return START_NOT_STICKY
        }
        if (Build.VERSION.SDK_INT >= Build.VERSION_CODES.Q) {
            startForeground(NOTIFICATION_ID, notification, ServiceInfo.FOREGROUND_SERVICE_TYPE_LOCATION)
        } else {
            startForeground(NOTIFICATION_ID, notification)
        }
        if (wakeLock == null) {
            val power = getSystemService(PowerManager::class.java)
            wakeLock = power?.newWakeLock(PowerManager.PARTIAL_WAKE_LOCK, "fieldwalk:positioning")?.also { it.acquire() }
        }
        session.start()
        // Android would start it anew without a session.
        return START_NOT_STICKY
    }

    override fun onDestroy() {
        wanted?.session?.stop()
        wanted = null
        wakeLock?.takeIf { it.isHeld }?.release()
        wakeLock = null
        super.onDestroy()
    }

    private data class Wanted(val session: PositioningSession, val notification: Notification)

    companion object {
        /** The number under which the notification is shown. */
        const val NOTIFICATION_ID = 0x4657

        @Volatile private var wanted: Wanted? = null

        /**
         * Runs [session] in the foreground service; called while the app is on the screen. Gives what is in the way, and
         * has done nothing then.
         *
         * @param notification the app's own, of a channel that it has made
         */
        fun begin(context: Context, session: PositioningSession, notification: Notification): Trouble? {
            // Android 14 throws when a service of this type starts without the permission.
            if (!Permissions.isGranted(context, permission.ACCESS_FINE_LOCATION)) return Permissions.locationTrouble(context)
            wanted = Wanted(session, notification)
            context.startForegroundService(Intent(context, PositioningService::class.java))
            return null
        }

        /** Stops the service and its session; nothing happens when none runs. */
        fun end(context: Context) {
            context.stopService(Intent(context, PositioningService::class.java))
        }
    }
}
