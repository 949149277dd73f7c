package org.fieldwalk.android

import org.junit.Assert.assertEquals
import org.junit.Assert.assertTrue
import org.junit.Test
import java.io.File

/** Positions never leave the device: neither the library nor the app can open a connection. */
class PrivacyTest {
    private val sources = File(System.getProperty("fieldwalk.android") ?: error("run by: cargo xtask android"))
    private val classes = File(System.getProperty("fieldwalk.classes")!!)

    @Test
    fun `no manifest asks for the network`() {
        val manifests = listOf("fieldwalk", "survey").map { File(sources, "$it/src/main/AndroidManifest.xml").readText() }
        assertTrue(manifests[0].contains("android.permission.BLUETOOTH_SCAN"))
        for (manifest in manifests) {
            val asked = Regex("android\\.permission\\.([A-Z_]+)").findAll(manifest).map { it.groupValues[1] }.toSet()
            assertEquals(emptySet<String>(), asked.filter { "INTERNET" in it || "NETWORK" in it }.toSet())
        }
        // Nor does it promise what would silence the beacons.
        assertTrue("neverForLocation" !in manifests[0].replace(Regex("<!--.*?-->", RegexOption.DOT_MATCHES_ALL), ""))
    }

    @Test
    fun `no class names a class of the network`() {
        val compiled = classes.walk().filter { it.extension == "class" }.toList()
        assertTrue("${compiled.size} classes", compiled.size > 100)
        val networked = compiled.filter { file ->
            val text = file.readBytes().toString(Charsets.ISO_8859_1)
            listOf("java/net/", "javax/net/", "android/net/Network", "android/webkit", "java/nio/channels/Socket").any { it in text }
        }
        assertEquals(emptyList<File>(), networked)
    }

    /** The compiler sees all of Android here, hidden parts too; what apps may call is a matter of names. */
    @Test
    fun `the library asks for nothing that its manifest does not name`() {
        val manifest = File(sources, "fieldwalk/src/main/AndroidManifest.xml").readText()
        for (sdk in 26..36) {
            val asked = Permissions.forBeacons(sdk) + Permissions.forBackground(sdk) + Permissions.forCards(sdk)
            assertEquals(emptyList<String>(), asked.filter { "\"$it\"" !in manifest })
        }
    }
}
