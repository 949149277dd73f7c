package org.fieldwalk.survey

import org.fieldwalk.ApiException
import org.fieldwalk.MissingInput
import org.fieldwalk.WalkRefusal
import org.fieldwalk.WalkReport
import org.fieldwalk.android.Trouble
import org.fieldwalk.android.TroubleKind
import java.io.IOException

/**
 * What to do about what the engine and the phone tell, by its stable code, in one language. Null for a code that came with a
 * newer engine: its own words are shown then, which are English.
 */
interface Remedies {
    fun of(refused: ApiException): String?
    fun of(missing: MissingInput): String?
    fun of(trouble: TroubleKind): String?
    fun of(refusal: WalkRefusal): String?
    /** These recordings are kept, and no part of the survey. */
    fun putAside(recordings: List<String>): String
}

/** What went wrong last. */
sealed interface Mishap {
    data class Failed(val cause: Throwable) : Mishap
    data class Unused(val report: WalkReport) : Mishap

    /** Recordings that were put aside, and why the last of them was. */
    data class PutAside(val recordings: List<String>, val why: Mishap?) : Mishap
}

internal fun Remedies.say(failure: Throwable): String = when (failure) {
    is ApiException -> of(failure) ?: Trouble.of(failure).remedy
    is IOException -> say(refusal(failure))
    else -> failure.message ?: failure.toString()
}

/** What the engine says of the same refusal. */
private fun refusal(io: IOException): ApiException {
    val message = io.message ?: io.toString()
    return if ("No space left on device" in message) ApiException.StorageFull(message, message)
    else ApiException.FileUnwritable(message, message)
}

internal fun Remedies.say(trouble: Trouble): String =
    (trouble.missing?.let(::of) ?: of(trouble.kind)) ?: trouble.remedy

internal fun Remedies.say(mishap: Mishap): String = when (mishap) {
    is Mishap.Failed -> say(mishap.cause)
    is Mishap.Unused -> mishap.report.refusal?.let(::of) ?: mishap.report.remedy
    is Mishap.PutAside -> listOfNotNull(putAside(mishap.recordings), mishap.why?.let { say(it) }).joinToString(" ")
}

// What a newer engine may tell is not known to the compiler here.
@Suppress("REDUNDANT_ELSE_IN_WHEN")
object EnglishRemedies : Remedies {
    override fun of(refused: ApiException) = when (refused) {
        is ApiException.MapNotFound, is ApiException.MapUnreadable -> "The map cannot be read: build it again."
        is ApiException.MapMalformed, is ApiException.MapCorrupt -> "The map is damaged: build it again."
        is ApiException.MapTooNew, is ApiException.BatchTooNew, is ApiException.RecordingTooNew, is ApiException.AdvertisementTooNew ->
            "This was made by a newer version: update the app."
        is ApiException.UnknownFloor, is ApiException.WrongFloor -> "This belongs to another floor: open that floor's survey."
        is ApiException.BadHint, is ApiException.BadWaypoint -> "Tap on the plan, one place after the other."
        is ApiException.TimeInPast -> "Wait a moment, then try again."
        is ApiException.RecordingNotFound, is ApiException.RecordingUnreadable -> "The recording cannot be read: walk there again."
        is ApiException.RecordingMalformed, is ApiException.RecordingCorrupt -> "The recording is damaged: walk there again."
        is ApiException.FileExists -> "There is such a file already: delete it first."
        is ApiException.FileUnwritable -> "The phone refuses to write: restart the app."
        is ApiException.StorageFull -> "The phone is full: free some space."
        is ApiException.PlanMalformed -> "The floor plan cannot be used: choose another file."
        is ApiException.OutOfTurn, is ApiException.Finished -> "That does not fit now: end the walk and begin another."
        is ApiException.SurveyIncomplete -> "There is no map in these walks: walk more lines, with a tap at both ends of each."
        is ApiException.AdvertisementForeign, is ApiException.AdvertisementMalformed -> "This is no card of Fieldwalk's: use one."
        is ApiException.UnknownSystem, is ApiException.BatchMalformed, is ApiException.BatchTorn,
        is ApiException.SnapshotMalformed, is ApiException.SnapshotForeign, is ApiException.Broken,
        -> "The app has failed: restart it. Walks that have ended are kept."
        else -> null
    }

    override fun of(missing: MissingInput) = when (missing) {
        MissingInput.SAMPLES -> "No sensor has spoken yet: wait a moment."
        MissingInput.START -> "Tap where you stand, or walk ten steps."
        MissingInput.ACCELEROMETER, MissingInput.ACCELEROMETER_RATE -> "Steps are missed: the accelerometer is silent or slow."
        MissingInput.GYROSCOPE -> "Turns are missed: the gyroscope is silent."
        MissingInput.MAGNETOMETER -> "The compass is silent: the map says nothing."
        MissingInput.RADIO -> "No beacon is heard: switch Bluetooth and location on."
        MissingInput.CARD_FRAMES -> "The card is silent: bring it near, and see to its battery."
        else -> null
    }

    override fun of(trouble: TroubleKind) = when (trouble) {
        TroubleKind.SENSOR_ABSENT -> "This phone lacks a sensor: use another one."
        TroubleKind.SENSORS_SILENT -> "Switch the sensors on in the quick settings, and leave this app on the screen."
        TroubleKind.CALIBRATION -> "Swing the phone slowly in a figure of eight, away from metal."
        TroubleKind.BLUETOOTH_PERMISSION -> "Allow the app to find devices nearby."
        TroubleKind.BLUETOOTH_OFF -> "Switch Bluetooth on."
        TroubleKind.BLUETOOTH_ABSENT -> "This phone hears no beacons: use another one where there are some."
        TroubleKind.BLUETOOTH_FAILED -> "Switch Bluetooth off and on."
        TroubleKind.LOCATION_PERMISSION -> "Allow the app the precise location."
        TroubleKind.LOCATION_OFF -> "Switch the location on."
        TroubleKind.WIFI_OFF -> "Switch WiFi on."
        TroubleKind.DOZING -> "Leave the screen on."
        else -> null
    }

    override fun of(refusal: WalkRefusal) = when (refusal) {
        WalkRefusal.NO_WAYPOINTS -> "This walk counts for nothing: tap at both ends of every line."
        WalkRefusal.NO_STEPS -> "This walk counts for nothing: walk between the taps, the phone in your hand."
        else -> null
    }

    override fun putAside(recordings: List<String>) =
        "Not in the survey any more, but kept and shared with it: ${recordings.joinToString()}."
}

@Suppress("REDUNDANT_ELSE_IN_WHEN")
object GermanRemedies : Remedies {
    override fun of(refused: ApiException) = when (refused) {
        is ApiException.MapNotFound, is ApiException.MapUnreadable -> "Die Karte ist nicht lesbar: bauen Sie sie neu."
        is ApiException.MapMalformed, is ApiException.MapCorrupt -> "Die Karte ist beschädigt: bauen Sie sie neu."
        is ApiException.MapTooNew, is ApiException.BatchTooNew, is ApiException.RecordingTooNew, is ApiException.AdvertisementTooNew ->
            "Das stammt von einer neueren Version: aktualisieren Sie die App."
        is ApiException.UnknownFloor, is ApiException.WrongFloor ->
            "Das gehört zu einem anderen Stockwerk: öffnen Sie dessen Vermessung."
        is ApiException.BadHint, is ApiException.BadWaypoint -> "Tippen Sie auf den Grundriss, einen Ort nach dem anderen."
        is ApiException.TimeInPast -> "Warten Sie einen Augenblick und versuchen Sie es noch einmal."
        is ApiException.RecordingNotFound, is ApiException.RecordingUnreadable ->
            "Die Aufzeichnung ist nicht lesbar: gehen Sie dort noch einmal."
        is ApiException.RecordingMalformed, is ApiException.RecordingCorrupt ->
            "Die Aufzeichnung ist beschädigt: gehen Sie dort noch einmal."
        is ApiException.FileExists -> "So eine Datei gibt es schon: löschen Sie sie zuerst."
        is ApiException.FileUnwritable -> "Das Telefon lässt nicht schreiben: starten Sie die App neu."
        is ApiException.StorageFull -> "Das Telefon ist voll: schaffen Sie Platz."
        is ApiException.PlanMalformed -> "Der Grundriss taugt nicht: wählen Sie eine andere Datei."
        is ApiException.OutOfTurn, is ApiException.Finished -> "Das passt jetzt nicht: beenden Sie den Gang und beginnen Sie einen neuen."
        is ApiException.SurveyIncomplete ->
            "Aus diesen Gängen wird keine Karte: gehen Sie mehr Linien, mit einem Tippen an beiden Enden."
        is ApiException.AdvertisementForeign, is ApiException.AdvertisementMalformed ->
            "Das ist kein Ausweis von Fieldwalk: nehmen Sie einen."
        is ApiException.UnknownSystem, is ApiException.BatchMalformed, is ApiException.BatchTorn,
        is ApiException.SnapshotMalformed, is ApiException.SnapshotForeign, is ApiException.Broken,
        -> "Die App ist gestört: starten Sie sie neu. Beendete Gänge bleiben erhalten."
        else -> null
    }

    override fun of(missing: MissingInput) = when (missing) {
        MissingInput.SAMPLES -> "Noch kein Sensor meldet sich: warten Sie einen Augenblick."
        MissingInput.START -> "Tippen Sie, wo Sie stehen, oder gehen Sie zehn Schritte."
        MissingInput.ACCELEROMETER, MissingInput.ACCELEROMETER_RATE ->
            "Schritte gehen verloren: der Beschleunigungssensor schweigt oder ist langsam."
        MissingInput.GYROSCOPE -> "Drehungen gehen verloren: das Gyroskop schweigt."
        MissingInput.MAGNETOMETER -> "Der Kompass schweigt: die Karte sagt nichts."
        MissingInput.RADIO -> "Kein Beacon zu hören: schalten Sie Bluetooth und Standort ein."
        MissingInput.CARD_FRAMES -> "Der Ausweis schweigt: bringen Sie ihn näher und prüfen Sie die Batterie."
        else -> null
    }

    override fun of(trouble: TroubleKind) = when (trouble) {
        TroubleKind.SENSOR_ABSENT -> "Diesem Telefon fehlt ein Sensor: nehmen Sie ein anderes."
        TroubleKind.SENSORS_SILENT ->
            "Schalten Sie die Sensoren in den Schnelleinstellungen ein und lassen Sie diese App auf dem Bildschirm."
        TroubleKind.CALIBRATION -> "Schwenken Sie das Telefon langsam in einer Acht, fern von Metall."
        TroubleKind.BLUETOOTH_PERMISSION -> "Erlauben Sie der App, Geräte in der Nähe zu finden."
        TroubleKind.BLUETOOTH_OFF -> "Schalten Sie Bluetooth ein."
        TroubleKind.BLUETOOTH_ABSENT -> "Dieses Telefon hört keine Beacons: nehmen Sie ein anderes, wo es welche gibt."
        TroubleKind.BLUETOOTH_FAILED -> "Schalten Sie Bluetooth aus und wieder ein."
        TroubleKind.LOCATION_PERMISSION -> "Erlauben Sie der App den genauen Standort."
        TroubleKind.LOCATION_OFF -> "Schalten Sie den Standort ein."
        TroubleKind.WIFI_OFF -> "Schalten Sie WLAN ein."
        TroubleKind.DOZING -> "Lassen Sie den Bildschirm an."
        else -> null
    }

    override fun of(refusal: WalkRefusal) = when (refusal) {
        WalkRefusal.NO_WAYPOINTS -> "Dieser Gang zählt nicht: tippen Sie an beiden Enden jeder Linie."
        WalkRefusal.NO_STEPS -> "Dieser Gang zählt nicht: gehen Sie von Tippen zu Tippen, das Telefon in der Hand."
        else -> null
    }

    override fun putAside(recordings: List<String>) =
        "Nicht mehr in der Vermessung, aber aufbewahrt und mit ihr geteilt: ${recordings.joinToString()}."
}
