import Foundation
import Testing

@testable import Fieldwalk
@testable import FieldwalkSurvey

/// A survey outlives the app: what is on the disk in the middle of a walk is the survey of the next start.
struct SurveyFolderTests {
    private let files = FileManager.default
    private let temporary = TemporaryFolder()
    private let floor = SurveyFolder.Floor(name: "F1", ordinal: 0, beaconUUIDs: Walk.beaconUUIDs)

    @Test func aSurveyThatTheEndOfTheAppCutGoesOn() async throws {
        let folder = try begun()
        let walks = try self.walks(in: folder)
        await walk(walks)
        await walks.endWalk()
        let whole = await walks.look()
        await walk(walks, nWaypoints: 4)
        let cut = await walks.look()
        #expect(whole.nWalks == 1 && cut.taps.count == 4)

        // The process is gone; nothing was saved on its way out.
        let kept = try copy(of: folder)
        #expect(kept.floor == floor)
        let again = try self.walks(in: kept)
        let state = await again.look()
        #expect(state.message == nil && state.phase == .idle)
        // The cut walk counts up to its last waypoint.
        #expect(state.nWalks == 2 && state.coverage == cut.coverage)
        #expect(abs(state.walkLengthsM[0] - whole.routeM) < 1e-9 && state.walkLengthsM[1] > 1)
        // And the survey goes on.
        await walk(again, nWaypoints: 3)
        await again.endWalk()
        #expect(await again.look().nWalks == 3 && kept.walks() == [1, 2, 3])
        await again.undoWalk()
        #expect(kept.walks() == [1, 2])
        #expect(await again.build() != nil)
    }

    @Test func whatWasTakenBackAndPausedStaysSo() async throws {
        let folder = try begun()
        let walks = try self.walks(in: folder)
        await walk(walks, nWaypoints: 3)
        await walks.undoTap()
        await walks.pause()
        await walks.resume()
        await walk(walks, from: 3, nWaypoints: 3)
        let cut = await walks.look()
        let kept = try copy(of: folder)
        // A line that was cut while it was written says nothing.
        let journal = kept.url.appendingPathComponent("1.journal")
        try (Data(contentsOf: journal) + Data("undo \(Walk.waypoints[5].timeNs)".utf8)).write(to: journal)
        let state = await (try self.walks(in: kept)).look()
        #expect(state.nWalks == 1 && state.coverage == cut.coverage)
        await walks.endWalk()
        let ended = await walks.look()
        #expect(abs(state.routeM - ended.routeM) < 1e-9)
        // Neither the line that was taken back nor the way during the pause.
        let points = Walk.waypoints.map(\.point)
        let lines = [(0, 1), (3, 4), (4, 5)].map { hypot(points[$1].xM - points[$0].xM, points[$1].yM - points[$0].yM) }
        #expect(abs(ended.routeM - lines.reduce(0, +)) < 0.01)
    }

    @Test func walksThatAreOfNoUseLeaveNothingBehind() async throws {
        let folder = try begun()
        let walks = try self.walks(in: folder)
        await walks.beginWalk()
        #expect(folder.walks() == [1])
        let cut = try copy(of: folder)
        await walks.endWalk()
        #expect(folder.walks().isEmpty)
        // Cut in its first second.
        let state = await (try self.walks(in: cut)).look()
        #expect(state.nWalks == 0 && state.message?.isEmpty == false && cut.walks().isEmpty)
    }

    @Test func aRecordingThatCannotBeReadIsToldOfAndStays() async throws {
        let folder = try begun()
        let walks = try self.walks(in: folder)
        await walk(walks)
        await walks.endWalk()
        try Data("no recording".utf8).write(to: folder.url.appendingPathComponent("2.mcap"))
        let again = try self.walks(in: folder)
        let state = await again.look()
        #expect(state.nWalks == 1 && state.message?.hasPrefix("walk 2: ") == true)
        await again.undoWalk()
        #expect(folder.walks() == [2])
    }

    @Test func aWalkThatCannotBeRecordedHasNotBegun() async throws {
        let folder = try begun()
        let engine = try SurveyorEngine(folder: folder)
        try files.removeItem(at: folder.url)
        #expect(throws: ApiError.self) { try engine.beginWalk("walk 1") }
        try files.createDirectory(at: folder.url, withIntermediateDirectories: true)
        try engine.beginWalk("walk 1")
    }

    @Test func aPlanThatIsNoneDropsNoSurvey() throws {
        let folder = try begun()
        #expect(throws: ApiError.self) {
            try folder.create(plan: Data("{}".utf8), floor: SurveyFolder.Floor(name: "F2", ordinal: 1))
        }
        #expect(folder.floor == floor)
        try files.removeItem(at: folder.url)
        #expect(folder.floor == nil)
        #expect(throws: (any Error).self) { _ = try SurveyorEngine(folder: folder) }
    }

    private func begun() throws -> SurveyFolder {
        let plan = try Data(contentsOf: Walk.folder.appendingPathComponent("plan.geojson"))
        let folder = SurveyFolder(temporary.url.appendingPathComponent("\(UUID())"))
        try folder.create(plan: plan, floor: floor)
        return folder
    }

    private func copy(of folder: SurveyFolder) throws -> SurveyFolder {
        let copy = SurveyFolder(temporary.url.appendingPathComponent("\(UUID())"))
        try files.copyItem(at: folder.url, to: copy.url)
        return copy
    }

    private let hand = Hand()

    private func walks(in folder: SurveyFolder) throws -> SurveyWalks {
        let hand = self.hand
        return SurveyWalks(engine: try SurveyorEngine(folder: folder), sensors: [hand], nowNs: { hand.nowNs })
    }

    /// So many waypoints of the walk, from one of them on; begins a walk when none is on.
    private func walk(_ walks: SurveyWalks, from first: Int = 0, nWaypoints: Int = .max) async {
        await walks.beginWalk()
        var n = 0
        for record in Walk.records {
            if n >= first, let sample = record.sample { hand.deliver(sample) }
            guard record.isWaypoint else { continue }
            n += 1
            hand.nowNs = record.timeNs
            if n > first { await walks.tap(record.point) }
            if n - first == nWaypoints { break }
        }
        #expect(await walks.look().message == nil)
    }
}

extension Walk {
    fileprivate static let waypoints = records.filter(\.isWaypoint)
}
