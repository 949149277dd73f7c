package org.fieldwalk.survey

import org.fieldwalk.ApiException
import org.fieldwalk.CarryFault
import org.fieldwalk.MissingInput
import org.fieldwalk.Rejections
import org.fieldwalk.WalkRefusal
import org.fieldwalk.WalkReport
import org.fieldwalk.android.Trouble
import org.fieldwalk.android.TroubleKind
import org.junit.Assert.assertEquals
import org.junit.Assert.assertNotEquals
import org.junit.Assert.assertTrue
import org.junit.Test

/** Every stable code of the engine and of the phone's side has its words in both languages. */
class RemediesTest {
    /** One of every case that was generated from the engine. */
    private val refusals: List<ApiException> = ApiException::class.java.declaredClasses
        .filter { ApiException::class.java.isAssignableFrom(it) }
        .map { it.getConstructor(String::class.java, String::class.java).newInstance("wrong", "mend it") as ApiException }

    @Test
    fun `no code is without words, and none speaks English in German`() {
        val kinds = TroubleKind.entries - listOf(TroubleKind.MAP, TroubleKind.ENGINE) // these have codes of their own
        assertTrue("${refusals.size} cases", refusals.size >= 32)
        val (english, german) = listOf(EnglishRemedies, GermanRemedies).map { remedies ->
            refusals.associate { it.javaClass.simpleName to remedies.of(it) } +
                MissingInput.entries.associate { it.name to remedies.of(it) } +
                kinds.associate { it.name to remedies.of(it) } +
                WalkRefusal.entries.associate { it.name to remedies.of(it) }
        }
        for ((code, words) in english) {
            assertTrue("$code: $words, ${german[code]}", !words.isNullOrEmpty() && !german[code].isNullOrEmpty())
            assertNotEquals(code, words, german[code])
        }
        val carried = CarryFault.entries.map(Warning::of)
        assertTrue(carried.all { English.warning(it).isNotEmpty() && English.warning(it) != German.warning(it) })
    }

    @Test
    fun `a code of a newer engine is told in the engine's own words`() {
        val refused = refusals.first()
        assertEquals("mend it", NoRemedies.say(refused))
        assertEquals("mend it", NoRemedies.say(Mishap.Failed(refused)))
        assertEquals("mend it", NoRemedies.say(Trouble(TroubleKind.ENGINE, "wrong", "mend it", missing = MissingInput.START)))
        val unused = WalkReport(false, "walk", 0u, 0u, 0.0, Rejections(0u, 0u, 0u, 0u), WalkRefusal.NO_STEPS)
        assertEquals("walk", NoRemedies.say(Mishap.Unused(unused)))
        assertEquals(GermanRemedies.of(WalkRefusal.NO_STEPS), GermanRemedies.say(Mishap.Unused(unused)))
    }
}

/** A language that knows no code. */
private object NoRemedies : Remedies {
    override fun of(refused: ApiException) = null
    override fun of(missing: MissingInput) = null
    override fun of(trouble: TroubleKind) = null
    override fun of(refusal: WalkRefusal) = null
    override fun putAside(recordings: List<String>) = ""
}
