package org.fieldwalk

import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Test
import java.io.File

/** The frames that every build of the card's firmware makes of one minute's walk; `firmware/golden/README.md` describes them. */
class GoldenFramesTest {
    private fun lines(name: String) = File(System.getProperty("fieldwalk.golden"), name).readLines()

    @Test
    fun `the card's frames are read as in Rust`() = CardDecoder().use { decoder ->
        val rounds = lines("walk-01.frames.txt").map { sent ->
            val frame = sent.substringAfter(' ').chunked(2).map { it.toInt(16).toByte() }.toByteArray()
            line(decoder.decodeAdvertisement(frame.toDirect()))
        }
        assertEquals(59, rounds.size)
        assertEquals(lines("walk-01.rounds.txt"), rounds)
    }

    private fun line(round: CardRound): String {
        val flags = listOf(round.isRepeated, round.isCalibrated, round.justWoke, round.isBatteryLow).map { if (it) 1 else 0 }
        val thirds = round.verticalFieldUt + round.horizontalFieldUt + round.previousStrengthUt +
            round.accelerationMaxMS2 + round.accelerationMinMS2
        val bits = (thirds + round.orientationRad).map { value -> value?.let { "%08x".format(it.toRawBits()) } }
        val words = listOf(round.cardId, round.sequence, round.nLost) + flags + round.batteryMv?.toInt() + bits
        return words.joinToString(" ") { it?.toString() ?: "-" }
    }
}
