import Fieldwalk
import Foundation
import Testing

@testable import FieldwalkSurvey

struct SurveyWalksTests {
    private let engine = RecordingEngine()
    private let sensors = TappedSensors()

    private func walks() -> SurveyWalks {
        SurveyWalks(engine: engine, sensors: [sensors], nowNs: { 1_000 })
    }

    @Test func aWalkIsSampledBetweenItsWaypointsAndCounts() async {
        let walks = walks()
        #expect(await walks.look().advice == "Begin a walk, then tap where you stand.")
        await walks.beginWalk()
        sensors.deliver(5)
        await walks.tap(Point2(xM: 1, yM: 2))
        sensors.deliver(7)
        await walks.tap(Point2(xM: 9, yM: 2))
        let walking = await walks.look()
        #expect(walking.taps.count == 2 && walking.nSteps == 3 && walking.remedies == ["switch Bluetooth on"])
        await walks.endWalk()
        #expect(sensors.isStopped)
        #expect(await walks.look().remedies.isEmpty)
        // Samples stand before the waypoint that came after them.
        #expect(
            engine.calls == [
                "begin walk 1", "push 5", "tap 1.0 2.0 at 1000", "push 7", "tap 9.0 2.0 at 1000", "end",
            ])
        let state = await walks.look()
        #expect(state.phase == .idle && state.nWalks == 1 && state.routeM == 8)
        #expect(state.summary == "1 walk, 8 m, 40 % covered")
    }

    @Test func whatComesDuringAPauseIsNotPushedAfterIt() async {
        let walks = walks()
        await walks.beginWalk()
        await walks.tap(Point2(xM: 1, yM: 1))
        await walks.pause()
        sensors.deliver(3)
        await walks.resume()
        #expect(await walks.look().taps.isEmpty)
        sensors.deliver(4)
        await walks.tap(Point2(xM: 5, yM: 1))
        await walks.endWalk()
        #expect(
            engine.calls == [
                "begin walk 1", "tap 1.0 1.0 at 1000", "pause", "push 3", "resume", "push 4", "tap 5.0 1.0 at 1000",
                "end",
            ])
    }

    @Test func waypointsAndWalksAreTakenBack() async {
        let walks = walks()
        await walks.beginWalk()
        await walks.tap(Point2(xM: 1, yM: 1))
        await walks.tap(Point2(xM: 2, yM: 1))
        await walks.undoTap()
        #expect(await walks.look().taps == [Point2(xM: 1, yM: 1)])
        await walks.undoTap()
        await walks.undoTap()
        #expect(await walks.look().taps.isEmpty)
        await walks.endWalk()
        await walks.undoWalk()
        await walks.undoWalk()
        let state = await walks.look()
        #expect(state.nWalks == 0 && state.routeM == 0)
    }

    @Test func aWalkThatTheMapCannotUseSaysWhatToDo() async {
        engine.remedy = "tap a waypoint at both ends of every line"
        let walks = walks()
        await walks.beginWalk()
        await walks.endWalk()
        let state = await walks.look()
        #expect(state.nWalks == 0 && state.message == engine.remedy)
        await walks.beginWalk()
        #expect(await walks.look().message == nil)
    }

    @Test func aRefusedWaypointShowsItsRemedyAndIsNotDrawn() async {
        engine.refusal = ApiError.BadHint(explanation: "it is not on the plan", remedy: "tap on the plan")
        let walks = walks()
        await walks.beginWalk()
        await walks.tap(Point2(xM: 1e9, yM: 1))
        let state = await walks.look()
        #expect(state.taps.isEmpty && state.message == "tap on the plan")
    }

    @Test func sensorsThatDoNotStartBeginNoWalk() async {
        let walks = SurveyWalks(engine: engine, sensors: [sensors, NoSensor()], nowNs: { 1 })
        await walks.beginWalk()
        let state = await walks.look()
        #expect(state.phase == .idle && state.message == "Missing()")
        #expect(engine.calls == ["begin walk 1", "end"] && sensors.isStopped)
    }

    @Test func callsOutOfTurnDoNothing() async {
        let walks = walks()
        await walks.tap(Point2(xM: 1, yM: 1))
        await walks.undoTap()
        await walks.pause()
        await walks.resume()
        await walks.endWalk()
        #expect(await walks.build() == nil)
        #expect(engine.calls.isEmpty)
        await walks.beginWalk()
        await walks.beginWalk()
        await walks.undoWalk()
        #expect(await walks.build() == nil)
        #expect(engine.calls == ["begin walk 1"])
    }

    @Test func aMapIsBuiltOrWhyNotIsSaid() async {
        let walks = walks()
        await walks.beginWalk()
        await walks.endWalk()
        #expect(await walks.build()?.file == Data([1, 2, 3]))
        engine.refusal = ApiError.Broken(explanation: "", remedy: "walk more")
        #expect(await walks.build() == nil)
        let state = await walks.look()
        #expect(state.phase == .idle && state.message == "walk more")
    }

    @Test(arguments: [
        (SurveyState.Phase.idle, 0, "begin"), (.idle, 1, "begin undoWalk build"), (.walking, 0, "tap pause end"),
        (.paused, 0, "resume end"), (.building, 1, ""),
    ])
    func eachPhaseHasItsButtons(phase: SurveyState.Phase, nWalks: Int, buttons: String) {
        var state = SurveyState()
        (state.phase, state.nWalks) = (phase, nWalks)
        let can = [
            ("begin", state.canBegin), ("tap", state.canTap), ("undoTap", state.canUndoTap), ("pause", state.canPause),
            ("resume", state.canResume), ("end", state.canEnd), ("undoWalk", state.canUndoWalk),
            ("build", state.canBuild),
        ]
        #expect(can.filter(\.1).map(\.0).joined(separator: " ") == buttons)
        state.taps = [Point2(xM: 0, yM: 0)]
        #expect(state.canUndoTap == (phase == .walking))
    }

    @Test func aWalkIsPausedBeforeTheSurveyIsLeft() async {
        let walks = walks()
        #expect(await !walks.look().isPausedToLeave)
        await walks.beginWalk()
        #expect(await walks.look().isPausedToLeave)
        await walks.pause()
        #expect(await !walks.look().isPausedToLeave)
    }

    @Test func whatOutlivedTheAppIsTakenInOnceBeforeAllElse() async {
        engine.kept = [
            WalkSummary(isUsed: true, remedy: "", nSteps: 5, routeM: 3),
            WalkSummary(isUsed: false, remedy: "tap more", nSteps: 0, routeM: 0),
        ]
        let walks = walks()
        let state = await walks.look()
        #expect(state.nWalks == 1 && state.routeM == 3 && state.message == "tap more" && state.canBuild)
        await walks.beginWalk()
        await walks.endWalk()
        #expect(await walks.look().nWalks == 2)
        #expect(engine.calls == ["begin walk 2", "end"])
    }

    @Test func whatKeepsBeaconsFromBeingHeardIsShownUntilOneIsHeard() async {
        var report: (@Sendable (BeaconTrouble) -> Void)?
        let beacons = BeaconWatch {
            report = $0
            return sensors
        }
        let walks = SurveyWalks(engine: engine, sensors: [], beacons: beacons, nowNs: { 1_000 })
        await walks.beginWalk()
        #expect(await walks.look().remedies == ["switch Bluetooth on"])
        report?(.notAuthorized)
        #expect(await walks.look().remedies == ["switch Bluetooth on", BeaconTrouble.notAuthorized.remedy])
        sensors.deliver(1)
        #expect(await walks.look().remedies == ["switch Bluetooth on"])
        report?(.rangingFailed)
        #expect(await walks.look().remedies.last == BeaconTrouble.rangingFailed.remedy)
        await walks.endWalk()
        #expect(sensors.isStopped)
        #expect(await walks.look().remedies.isEmpty)
        // The next walk's source says it again, if it is so.
        await walks.beginWalk()
        #expect(await walks.look().remedies == ["switch Bluetooth on"])
    }
}

/// An engine that writes down what it is told.
private final class RecordingEngine: SurveyEngine, @unchecked Sendable {
    private let lock = NSLock()
    private var told: [String] = []
    private var taps: [Point2] = []
    private var nEnded = 0
    var remedy = ""
    var refusal: ApiError?
    var kept: [WalkSummary] = []

    var calls: [String] { lock.withLock { told } }

    private func tell(_ call: String) { lock.withLock { told.append(call) } }

    func plan() -> PlanLines { PlanLines(widthM: 10, heightM: 10) }
    func restore() -> [WalkSummary] { kept }
    func beginWalk(_ name: String) { tell("begin \(name)") }

    func push(_ batch: Data) throws {
        // The number of records, at its place in the header.
        tell("push \(batch[6])")
    }

    func tap(_ point: Point2, atNs timeNs: Int64) throws {
        if let refusal { throw refusal }
        tell("tap \(point.xM) \(point.yM) at \(timeNs)")
        taps.append(point)
    }

    func undoTap() -> Point2? { taps.popLast() }

    func pause(atNs timeNs: Int64) { tell("pause") }
    func resume() { tell("resume") }

    func endWalk() -> WalkSummary {
        tell("end")
        if remedy.isEmpty { nEnded += 1 }
        return WalkSummary(isUsed: remedy.isEmpty, remedy: remedy, nSteps: 12, routeM: 8)
    }

    func undoWalk() -> Bool {
        defer { nEnded = max(nEnded - 1, 0) }
        return nEnded > 0
    }

    func progress() -> WalkProgress { WalkProgress(nSteps: 3, remedies: ["switch Bluetooth on"]) }

    func coverage() -> CoverageGrid {
        CoverageGrid(openM2: 10, coveredM2: 4, cellM: 1, nColumns: 1, nRows: 1, nodes: [2])
    }

    func build() throws -> BuiltMap {
        if let refusal { throw refusal }
        return BuiltMap(file: Data([1, 2, 3]), expectedMedianM: 1, expectedP90M: 2)
    }
}

/// Sensors that deliver when told.
private final class TappedSensors: SensorSource, @unchecked Sendable {
    private var sink: (@Sendable (SensorSample) -> Void)?

    var isStopped: Bool { sink == nil }
    func start(_ deliver: @escaping @Sendable (SensorSample) -> Void) { sink = deliver }
    func stop() { sink = nil }

    /// So many samples, close enough to wait for the next.
    func deliver(_ n: Int) {
        for k in 0..<n { sink?(.pressure(timeNs: Int64(k), hpa: 1000)) }
    }
}

private struct NoSensor: SensorSource {
    struct Missing: Error {}
    func start(_ deliver: @escaping @Sendable (SensorSample) -> Void) throws { throw Missing() }
    func stop() {}
}
