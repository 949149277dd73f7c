package org.fieldwalk.survey

import android.view.View
import android.widget.Button
import android.widget.TextView
import org.fieldwalk.BuildingMap
import org.fieldwalk.RecordingReader
import org.junit.Assert.assertEquals
import org.junit.Assert.assertFalse
import org.junit.Assert.assertTrue
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.RobolectricTestRunner
import org.robolectric.annotation.Config
import org.robolectric.annotation.GraphicsMode
import org.robolectric.shadows.ShadowAlertDialog
import java.io.File

/** Several floors, one after the other, on one phone. */
@RunWith(RobolectricTestRunner::class)
@Config(qualifiers = "w411dp-h891dp-420dpi")
@GraphicsMode(GraphicsMode.Mode.NATIVE)
class SurveysTest : DrivenApp() {
    private val recordings = RecordedFloor.surveyWalks

    @Test
    fun `a second floor stands beside the first, whose late map finds its own place`() {
        val ground = openPlan("F1")
        ground.press(SurveyIds.BEGIN)
        walk(ground, recordings[0])
        ground.press(SurveyIds.END)
        ground.press(SurveyIds.BUILD)
        val first = folder()
        // The build has not begun when the surveyor is upstairs already.
        val upstairs = openPlan("F2")
        assertEquals("0 walks", upstairs.text(SurveyIds.SUMMARY).substringBefore(','))
        upstairs.press(SurveyIds.BEGIN)
        walk(upstairs, recordings[0], nWaypoints = 4)
        val second = folder()
        assertTrue(first.name != second.name)
        runLater()
        assertTrue(first.mapFile.isFile)
        assertFalse("no map of the other floor", second.mapFile.isFile || walks().state.value.hasMap)

        // In mid-walk the surveyor goes on with the first: the walk upstairs has ended, and nothing is lost.
        val start = open(StartActivity::class.java)
        val labels = (0..1).map { start.view<Button>(SurveyIds.CONTINUE + it).text }
        assertTrue("$labels", labels[0].startsWith("Continue F2, 1 walk, ") && labels[1].startsWith("Continue F1, 1 walk, "))
        shoot(start.get(), "start-two-floors")
        start.press(SurveyIds.CONTINUE + 1)
        val again = followed(start)
        assertTrue(again.text(SurveyIds.SUMMARY).startsWith("1 walk"))
        assertEquals("F1", again.get().title)
        val back = open(StartActivity::class.java)
        back.press(SurveyIds.CONTINUE)
        assertEquals("F2", followed(back).get().title)
        assertEquals(1, walks().state.value.nWalks)
    }

    @Test
    fun `the map and the recordings of an upper floor say the same number, after the end of the app too`() {
        val survey = openPlan("F2")
        CurrentSurvey.forget()
        survey.recreate()
        survey.press(SurveyIds.BEGIN)
        walk(survey, recordings[0])
        survey.press(SurveyIds.END)
        survey.press(SurveyIds.BUILD)
        runLater()
        assertEquals(1 to 1, numbers(folder()))
    }

    @Test
    fun `the number goes with the name until the surveyor says another`() {
        val start = open(StartActivity::class.java)
        val name = start.view<TextView>(SurveyIds.FLOOR_NAME)
        val shown = { start.text(SurveyIds.ORDINAL) }
        for ((floor, ordinal) in listOf("F2" to 1, "B1" to -1, "" to 0, "12F" to 11)) {
            name.text = floor
            assertEquals(English.floorNumber(ordinal), shown())
        }
        // Where the ground floor is called G, F1 is the one above.
        name.text = "F1"
        start.press(SurveyIds.HIGHER)
        start.press(SurveyIds.HIGHER)
        start.press(SurveyIds.LOWER)
        assertEquals(English.floorNumber(1), shown())
        start.recreate()
        assertEquals("a turn of the screen keeps it", English.floorNumber(1), shown())
        choose(start, RecordedFloor.plan)
        val survey = followed(start)
        survey.press(SurveyIds.BEGIN)
        walk(survey, recordings[0])
        survey.press(SurveyIds.END)
        survey.press(SurveyIds.BUILD)
        runLater()
        assertEquals("a name that would contradict is left out", 1 to null, numbers(folder()))
    }

    @Test
    fun `floors are numbered as the engine numbers them`() {
        val engine = File(System.getProperty("fieldwalk.android")!!, "../formats/src/ilc/floor.rs").readText()
        val cases = Regex("\\(\"([^\"]*)\", (-?\\d+|i32::MAX - 1)\\),").findAll(engine)
            .associate { (it.groupValues[1]) to (it.groupValues[2].toIntOrNull() ?: (Int.MAX_VALUE - 1)) }
        assertTrue("${cases.size} cases", cases.size >= 15)
        assertEquals(cases, cases.mapValues { floorOrdinal(it.key) })
    }

    @Test
    @Config(qualifiers = "de-w411dp-h891dp-night-420dpi")
    fun `a survey is deleted after a question that says what is in it`() {
        val survey = openPlan("F2")
        survey.press(SurveyIds.BEGIN)
        walk(survey, recordings[0], nWaypoints = 4)
        survey.press(SurveyIds.END)
        openPlan("B1")
        val start = open(StartActivity::class.java)
        shoot(start.get(), "start-two-floors-german-night")
        start.press(SurveyIds.DELETE + 1)
        assertEquals(German.reallyDelete("F2", 1, isShared = false), shadowMessage())
        answer(isYes = false)
        assertEquals(2, CurrentSurvey.all(phone.context).size)
        CurrentSurvey.of(phone.context, CurrentSurvey.all(phone.context)[1].name)!!.readyToShare()
        start.press(SurveyIds.DELETE + 1)
        assertEquals(German.reallyDelete("F2", 1, isShared = true), shadowMessage())
        answer(isYes = true)
        assertEquals(listOf("B1"), CurrentSurvey.all(phone.context).map { it.floor })
        assertEquals(null, start.get().findViewById<View>(SurveyIds.CONTINUE + 1))
    }

    private fun shadowMessage() =
        ShadowAlertDialog.getLatestAlertDialog().requireViewById<TextView>(android.R.id.message).text.toString()

    private fun answer(isYes: Boolean) {
        val button = if (isYes) android.app.AlertDialog.BUTTON_POSITIVE else android.app.AlertDialog.BUTTON_NEGATIVE
        ShadowAlertDialog.getLatestAlertDialog().getButton(button).performClick()
        phone.settle()
    }

    /** The floor's number in the map and in a recording. */
    private fun numbers(folder: SurveyFolder): Pair<Int, Int?> {
        val inMap = BuildingMap.fromFile(folder.mapFile.readBytes().toDirect()).use { it.floors().single().ordinal }
        val inRecording = RecordingReader.open(folder.recordings().single().path).use { reader ->
            generateSequence { reader.nextPart(UInt.MAX_VALUE) }.count()
            reader.floor()
        }
        return inMap to inRecording
    }
}
