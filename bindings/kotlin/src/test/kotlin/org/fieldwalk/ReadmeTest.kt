package org.fieldwalk

import org.fieldwalk.readme.follow
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test
import java.io.ByteArrayOutputStream
import java.io.PrintStream

/** The README's example, put into a source by `cargo xtask kotlin`, runs. */
class ReadmeTest {
    @Test
    fun `the example of the readme prints a fix for every step`() {
        val expected = Walk.openMap().use { map ->
            Positioner(map, 0).use {
                it.hint(Walk.hint)
                it.pushSamples(batchOf(Walk.samples).bytes())
            }
        }
        val printed = ByteArrayOutputStream()
        val usual = System.out
        System.setOut(PrintStream(printed, true, "UTF-8"))
        try {
            follow(Walk.mapFolder.path, Walk.samples.chunked(40).map(::batchOf).asSequence(), Walk.hint)
        } finally {
            System.setOut(usual)
        }
        assertTrue(expected.size > 50, "${expected.size} fixes")
        val lines = expected.map { "${it.position} ± ${it.radius68M} m" }
        assertEquals(lines, printed.toString("UTF-8").lines().dropLast(1))
    }
}
