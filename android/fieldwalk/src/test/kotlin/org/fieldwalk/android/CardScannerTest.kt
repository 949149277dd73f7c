package org.fieldwalk.android

import kotlinx.coroutines.CoroutineScope
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.cancel
import kotlinx.coroutines.launch
import org.fieldwalk.CardDecoder
import org.junit.Assert.assertArrayEquals
import org.junit.Assert.assertEquals
import org.junit.Assert.assertNull
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.RobolectricTestRunner

@RunWith(RobolectricTestRunner::class)
class CardScannerTest {
    private val phone = SimulatedPhone()
    private val address = byteArrayOf(-64, 1, 2, 3, 4, 5)

    /** Card 42, round 7. */
    private val frame = ByteArray(31).also { byteArrayOf(2, 1, 6, 0x1b, -1, -1, -1, 0x11, 100, 7, 42).copyInto(it) }

    @Test
    fun `frames of cards are heard, and nothing else`() {
        phone.grantAll()
        val scanner = CardScanner(phone.context)
        assertNull(scanner.trouble())
        val heard = mutableListOf<CardSighting>()
        val reader = CoroutineScope(Dispatchers.Unconfined)
        reader.launch { scanner.sightings().collect(heard::add) }
        assertEquals(1, phone.nScans)
        phone.hearBle(5_000, -60, address, frame + ByteArray(31))
        phone.hearBle(6_000, -60, address, SimulatedPhone.ibeacon(ByteArray(16), 1, 2))
        phone.hearBle(7_000, -61, address, frame.copyOf(20))
        reader.cancel()
        assertEquals(0, phone.nScans)
        val sighting = heard.single()
        assertEquals(5_000L to -60f, sighting.timeNs to sighting.rssiDbm)
        assertArrayEquals(frame, sighting.frame)
        CardDecoder().use { assertEquals(42.toUShort(), it.decodeAdvertisement(sighting.frame.toDirect()).cardId) }
    }
}
