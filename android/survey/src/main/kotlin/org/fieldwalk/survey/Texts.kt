package org.fieldwalk.survey

import java.util.Locale
import kotlin.math.roundToInt

/** What the app says. In code, since the app has no other resources. */
interface Texts {
    val title: String
    val choosePlan: String
    val floorName: String
    val lowerFloor: String
    val higherFloor: String
    val delete: String
    val keep: String
    val beginWalk: String
    val endWalk: String
    val undoTap: String
    val undoWalk: String
    val pause: String
    val resume: String
    val buildMap: String
    val checkWalk: String
    val share: String
    val planDescription: String
    val tapYourPlace: String
    val noFixYet: String
    val planUnreadable: String
    val remedies: Remedies

    fun floorNumber(ordinal: Int): String
    fun continueSurvey(floor: String, nWalks: Int, begun: String): String
    fun reallyDelete(floor: String, nWalks: Int, isShared: Boolean): String
    fun advice(state: SurveyState): String
    fun summary(state: SurveyState): String
    fun accuracy(medianM: Double, p90M: Double): String
    fun steps(n: Int): String
    fun warning(warning: Warning): String
    fun fix(radiusM: Double, isStale: Boolean): String

    companion object {
        fun of(locale: Locale): Texts = if (locale.language == "de") German else English
    }
}

object English : Texts {
    override val title = "Fieldwalk survey"
    override val choosePlan = "Choose a floor plan"
    override val floorName = "Name of the floor"
    override val lowerFloor = "One floor lower"
    override val higherFloor = "One floor higher"
    override val delete = "Delete"
    override val keep = "Keep"
    override val beginWalk = "Begin a walk"
    override val endWalk = "End the walk"
    override val undoTap = "Undo tap"
    override val undoWalk = "Undo walk"
    override val pause = "Pause"
    override val resume = "Resume"
    override val buildMap = "Build the map"
    override val checkWalk = "Check walk"
    override val share = "Share"
    override val planDescription = "Floor plan. Tap where you stand."
    override val tapYourPlace = "Tap where you stand, then walk."
    override val noFixYet = "No position yet."
    override val planUnreadable = "This is no floor plan in GeoJSON."
    override val remedies = EnglishRemedies

    override fun floorNumber(ordinal: Int) = "Floor number: $ordinal (0 is the ground floor)"

    override fun continueSurvey(floor: String, nWalks: Int, begun: String) =
        "Continue $floor, ${walks(nWalks)}, begun $begun"

    override fun reallyDelete(floor: String, nWalks: Int, isShared: Boolean) =
        "Delete the survey of $floor with ${walks(nWalks)}? " +
            if (isShared) "Sharing was opened since it last changed: make sure that it arrived."
            else "It has not been shared as it is now: only this phone has it."

    private fun walks(n: Int) = if (n == 1) "1 walk" else "$n walks"

    override fun advice(state: SurveyState) = when (state.phase) {
        Phase.IDLE -> if (state.nWalks == 0) "Begin a walk, then tap where you stand." else "Begin another walk, or build the map."
        Phase.WALKING ->
            if (state.taps.isEmpty()) "Tap where you stand." else "Walk in a straight line; tap where you turn or stop."
        Phase.PAUSED -> "Paused: resume, then tap where you stand."
        Phase.BUILDING -> "Building the map…"
    }

    override fun summary(state: SurveyState) =
        "${walks(state.nWalks)}, ${state.routeM.roundToInt()} m, ${state.coveredPercent} % covered"

    override fun accuracy(medianM: Double, p90M: Double) =
        String.format(Locale.ENGLISH, "Expected error: %.1f m, nine of ten under %.1f m", medianM, p90M)

    override fun steps(n: Int) = if (n == 1) "1 step" else "$n steps"

    override fun warning(warning: Warning) = when (warning) {
        Warning.TOO_FAST -> "That was faster than one walks: tap in time, and undo a tap that came late."
        Warning.NO_STEPS -> "No steps are seen: walk, and hold the phone before you."
        Warning.NOT_HELD -> "The phone swings or is put away: hold it still before you, the screen up."
        Warning.NOT_UPWARD -> "The screen does not face up: hold the phone level, as if to read from it."
        Warning.NOT_FORWARD -> "The phone is turned: let its top edge point where you go."
        Warning.NOT_LEVEL -> "The phone is tilted: hold it level."
        Warning.CALIBRATION -> "The compass is not calibrated: swing the phone in a figure of eight."
        Warning.BLUETOOTH -> "No beacons are heard: switch Bluetooth on and allow devices nearby."
        Warning.LOCATION -> "Neither beacons nor WiFi are heard: switch the location on and allow the precise one."
        Warning.SENSORS -> "A sensor is missing or silent: this phone is not fit to survey."
    }

    override fun fix(radiusM: Double, isStale: Boolean) =
        String.format(Locale.ENGLISH, if (isStale) "Lost since a while: within %.1f m" else "Within %.1f m", radiusM)
}

object German : Texts {
    override val title = "Fieldwalk-Vermessung"
    override val choosePlan = "Grundriss wählen"
    override val floorName = "Name des Stockwerks"
    override val lowerFloor = "Ein Stockwerk tiefer"
    override val higherFloor = "Ein Stockwerk höher"
    override val delete = "Löschen"
    override val keep = "Behalten"
    override val beginWalk = "Gang beginnen"
    override val endWalk = "Gang beenden"
    override val undoTap = "Tippen zurück"
    override val undoWalk = "Gang zurück"
    override val pause = "Pause"
    override val resume = "Weiter"
    override val buildMap = "Karte bauen"
    override val checkWalk = "Probegang"
    override val share = "Teilen"
    override val planDescription = "Grundriss. Tippen Sie, wo Sie stehen."
    override val tapYourPlace = "Tippen Sie, wo Sie stehen, und gehen Sie los."
    override val noFixYet = "Noch keine Position."
    override val planUnreadable = "Das ist kein Grundriss in GeoJSON."
    override val remedies = GermanRemedies

    override fun floorNumber(ordinal: Int) = "Stockwerk Nummer $ordinal (0 ist das Erdgeschoss)"

    override fun continueSurvey(floor: String, nWalks: Int, begun: String) =
        "$floor fortsetzen, ${walks(nWalks)}, begonnen $begun"

    override fun reallyDelete(floor: String, nWalks: Int, isShared: Boolean) =
        "Die Vermessung von $floor löschen, ${walks(nWalks)}? " +
            if (isShared) "Seit ihrer letzten Änderung wurde Teilen geöffnet: prüfen Sie, ob sie ankam."
            else "So wie sie jetzt ist, wurde sie nicht geteilt: nur dieses Telefon hat sie."

    private fun walks(n: Int) = if (n == 1) "1 Gang" else "$n Gänge"

    override fun advice(state: SurveyState) = when (state.phase) {
        Phase.IDLE ->
            if (state.nWalks == 0) "Beginnen Sie einen Gang und tippen Sie, wo Sie stehen."
            else "Beginnen Sie einen weiteren Gang oder bauen Sie die Karte."
        Phase.WALKING ->
            if (state.taps.isEmpty()) "Tippen Sie, wo Sie stehen."
            else "Gehen Sie geradeaus; tippen Sie, wo Sie abbiegen oder halten."
        Phase.PAUSED -> "Pause: gehen Sie weiter und tippen Sie, wo Sie stehen."
        Phase.BUILDING -> "Die Karte wird gebaut …"
    }

    override fun summary(state: SurveyState) =
        "${walks(state.nWalks)}, ${state.routeM.roundToInt()} m, ${state.coveredPercent} % abgedeckt"

    override fun accuracy(medianM: Double, p90M: Double) =
        String.format(Locale.GERMAN, "Erwarteter Fehler: %.1f m, neun von zehn unter %.1f m", medianM, p90M)

    override fun steps(n: Int) = if (n == 1) "1 Schritt" else "$n Schritte"

    override fun warning(warning: Warning) = when (warning) {
        Warning.TOO_FAST -> "Das war schneller, als man geht: rechtzeitig tippen, spätes Tippen zurücknehmen."
        Warning.NO_STEPS -> "Keine Schritte erkannt: gehen Sie und halten Sie das Telefon vor sich."
        Warning.NOT_HELD -> "Das Telefon schwingt oder ist weggesteckt: halten Sie es ruhig vor sich, Bildschirm nach oben."
        Warning.NOT_UPWARD -> "Der Bildschirm zeigt nicht nach oben: halten Sie das Telefon flach, wie zum Lesen."
        Warning.NOT_FORWARD -> "Das Telefon ist verdreht: die obere Kante zeigt dorthin, wohin Sie gehen."
        Warning.NOT_LEVEL -> "Das Telefon ist geneigt: halten Sie es flach."
        Warning.CALIBRATION -> "Der Kompass ist nicht kalibriert: schwenken Sie das Telefon in einer Acht."
        Warning.BLUETOOTH -> "Keine Beacons zu hören: Bluetooth einschalten und Geräte in der Nähe erlauben."
        Warning.LOCATION -> "Weder Beacons noch WLAN zu hören: Standort einschalten und den genauen erlauben."
        Warning.SENSORS -> "Ein Sensor fehlt oder schweigt: dieses Telefon taugt nicht zum Vermessen."
    }

    override fun fix(radiusM: Double, isStale: Boolean) =
        String.format(Locale.GERMAN, if (isStale) "Seit einer Weile verloren: innerhalb %.1f m" else "Innerhalb %.1f m", radiusM)
}
