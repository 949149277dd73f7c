package org.fieldwalk.android

import android.app.Notification
import android.app.NotificationChannel
import android.app.NotificationManager
import org.fieldwalk.Walk
import org.junit.Assert.assertEquals
import org.junit.Assert.assertFalse
import org.junit.Assert.assertNull
import org.junit.Assert.assertTrue
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.Robolectric
import org.robolectric.RobolectricTestRunner
import org.robolectric.Shadows.shadowOf
import org.robolectric.shadows.ShadowPowerManager

@RunWith(RobolectricTestRunner::class)
class ServiceTest {
    private val phone = SimulatedPhone()

    private fun notification(): Notification {
        val channel = NotificationChannel("walk", "Walk", NotificationManager.IMPORTANCE_LOW)
        phone.context.getSystemService(NotificationManager::class.java)!!.createNotificationChannel(channel)
        return Notification.Builder(phone.context, "walk").setSmallIcon(android.R.drawable.ic_menu_mylocation).build()
    }

    @Test
    fun `without the permission nothing starts, and the remedy is said`() {
        val session = Walk.openMap().use { Fieldwalk.positioner(phone.context, it) }
        val trouble = PositioningService.begin(phone.context, session, notification())!!
        assertEquals(TroubleKind.LOCATION_PERMISSION, trouble.kind)
        assertNull(shadowOf(phone.context).nextStartedService)
        session.close()
    }

    @Test
    fun `the service runs the session awake, in the foreground, until it ends`() {
        phone.grantAll()
        val session = Walk.openMap().use { Fieldwalk.positioner(phone.context, it) }
        assertNull(PositioningService.begin(phone.context, session, notification()))
        val intent = shadowOf(phone.context).nextStartedService
        val controller = Robolectric.buildService(PositioningService::class.java, intent).create()
        repeat(2) { controller.startCommand(0, it) }
        val service = shadowOf(controller.get())
        assertEquals(PositioningService.NOTIFICATION_ID, service.lastForegroundNotificationId)
        assertTrue(session.status.value.isRunning)
        val lock = ShadowPowerManager.getLatestWakeLock()!!
        assertTrue(lock.isHeld)
        controller.destroy()
        assertFalse(lock.isHeld || session.status.value.isRunning)
        session.close()
    }

    @Test
    fun `a service that Android starts by itself has no session and stops`() {
        val controller = Robolectric.buildService(PositioningService::class.java).create().startCommand(0, 1)
        assertTrue(shadowOf(controller.get()).isStoppedBySelf)
        controller.destroy()
    }
}
