package org.fieldwalk.android

import android.app.Notification
import android.app.NotificationChannel
import android.app.NotificationManager
import org.fieldwalk.Walk
import org.junit.After
import org.junit.Assert.assertEquals
import org.junit.Assert.assertFalse
import org.junit.Assert.assertNull
import org.junit.Assert.assertTrue
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.Robolectric
import org.robolectric.RobolectricTestRunner
import org.robolectric.Shadows.shadowOf
import org.robolectric.android.controller.ServiceController
import org.robolectric.shadows.ShadowPowerManager

@RunWith(RobolectricTestRunner::class)
class ServiceTest {
    private val phone = SimulatedPhone()

    private fun notification(): Notification {
        val channel = NotificationChannel("walk", "Walk", NotificationManager.IMPORTANCE_LOW)
        phone.context.getSystemService(NotificationManager::class.java)!!.createNotificationChannel(channel)
        return Notification.Builder(phone.context, "walk").setSmallIcon(android.R.drawable.ic_menu_mylocation).build()
    }

    private val sessions = mutableListOf<PositioningSession>()

    @After
    fun close() {
        PositioningService.end(phone.context)
        sessions.forEach { it.close() }
    }

    private fun session() = Walk.openMap().use { Fieldwalk.positioner(phone.context, it) }.also(sessions::add)

    private fun begin(session: PositioningSession) =
        assertNull(PositioningService.begin(phone.context, session, notification()))

    private fun end() = PositioningService.end(phone.context)

    /** Android's next start, delivered to a service that there is, or to a new one. */
    private fun deliver(service: ServiceController<PositioningService>? = null): ServiceController<PositioningService> {
        val intent = shadowOf(phone.context).nextStartedService!!
        return (service ?: Robolectric.buildService(PositioningService::class.java, intent).create())
            .also { it.get().onStartCommand(intent, 0, ++nStarts) }
    }

    private var nStarts = 0

    /** Stops that Android was asked for, which it delivers as an end of the service. */
    private fun nStops() = generateSequence { shadowOf(phone.context).nextStoppedService }.count()

    private fun PositioningSession.isRunning() = status.value.isRunning

    private fun ServiceController<PositioningService>.isInForeground() =
        shadowOf(get()).lastForegroundNotificationId == PositioningService.NOTIFICATION_ID

    private fun ServiceController<PositioningService>.hasStopped() = shadowOf(get()).isStoppedBySelf

    @Test
    fun `without the permission nothing starts, and the remedy is said`() {
        val session = session()
        val trouble = PositioningService.begin(phone.context, session, notification())!!
        assertEquals(TroubleKind.LOCATION_PERMISSION, trouble.kind)
        assertNull(shadowOf(phone.context).nextStartedService)
    }

    @Test
    fun `the service runs the session awake, in the foreground, until it ends`() {
        phone.grantAll()
        val session = session()
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
    }

    @Test
    fun `a service that Android starts by itself has no session and stops`() {
        val controller = Robolectric.buildService(PositioningService::class.java).create().startCommand(0, 1)
        assertTrue(shadowOf(controller.get()).isStoppedBySelf)
        controller.destroy()
    }

    @Test
    fun `a session begun before the last one's service has ended runs in the next service`() {
        phone.grantAll()
        val (first, second) = List(2) { session() }
        begin(first)
        val service = deliver()
        end()
        begin(second)
        assertEquals(1, nStops())
        // Android ends the old service only now.
        service.destroy()
        assertFalse(first.isRunning())
        val next = deliver()
        assertTrue(next.isInForeground() && second.isRunning())
        assertFalse(next.hasStopped())
        end()
        assertEquals(1, nStops())
        next.destroy()
        assertFalse(second.isRunning())
    }

    @Test
    fun `an end before Android has started the service waits for it`() {
        phone.grantAll()
        val session = session()
        begin(session)
        end()
        // A stop now would end the app, and so would a start without a notification.
        assertEquals(0, nStops())
        val service = deliver()
        assertTrue(service.isInForeground() && service.hasStopped())
        assertFalse(session.isRunning())
        service.destroy()
        // Begun anew before the start that is not wanted any more: the last word counts.
        begin(session)
        end()
        begin(session)
        val next = deliver()
        deliver(next)
        assertTrue(next.isInForeground() && session.isRunning())
        assertFalse(next.hasStopped())
        next.destroy()
    }

    @Test
    fun `a session begun while another runs takes its place`() {
        phone.grantAll()
        val (first, second) = List(2) { session() }
        begin(first)
        val service = deliver()
        begin(second)
        assertTrue(first.isRunning())
        deliver(service)
        assertEquals(false to true, first.isRunning() to second.isRunning())
        service.destroy()
        assertFalse(second.isRunning())
        // Both before Android has started the service.
        begin(first)
        begin(second)
        val next = deliver()
        deliver(next)
        assertEquals(false to true, first.isRunning() to second.isRunning())
        next.destroy()
        assertFalse(second.isRunning())
    }

    @Test
    fun `a session that is closed meanwhile ends the service`() {
        phone.grantAll()
        val session = session()
        begin(session)
        session.close()
        val service = deliver()
        assertTrue(service.isInForeground() && service.hasStopped())
        service.destroy()
    }
}
