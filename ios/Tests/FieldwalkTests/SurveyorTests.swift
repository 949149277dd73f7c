import FieldwalkSurvey
import Foundation
import Testing

@testable import Fieldwalk

/// The survey app's logic on Fieldwalk's own surveyor: the simulated walk becomes a map.
struct SurveyorTests {
    private let temporary = TemporaryFolder()

    private func engine() throws -> SurveyorEngine {
        let plan = try Data(contentsOf: Walk.folder.appendingPathComponent("plan.geojson"))
        let folder = newFolder()
        try folder.create(plan: plan, floor: SurveyFolder.Floor(name: "F1", ordinal: 0))
        return try SurveyorEngine(folder: folder)
    }

    @Test func aWalkWithTapsBecomesAMapThatPositions() async throws {
        let engine = try engine()
        #expect(engine.plan().widthM == 26 && engine.plan().heightM == 20 && !engine.plan().rings.isEmpty)
        let hand = Hand()
        let walks = SurveyWalks(engine: engine, sensors: [hand], nowNs: { hand.nowNs })
        await walks.beginWalk()
        for record in Walk.records {
            hand.nowNs = record.timeNs
            if record.isWaypoint {
                await walks.tap(record.point)
                #expect(await walks.look().message == nil)
            } else if let sample = record.sample {
                hand.deliver(sample)
            }
        }
        let walking = await walks.look()
        #expect(walking.nSteps > 50 && walking.taps.count > 2)
        await walks.endWalk()
        let state = await walks.look()
        #expect(state.nWalks == 1 && state.routeM > 20 && state.message == nil)
        let coverage = try #require(state.coverage)
        #expect(coverage.share > 0.2 && CoverageImage(coverage) != nil)

        let built = try #require(await walks.build())
        let map = try BuildingMap.fromFile(file: built.file)
        #expect(map.floors() == [FloorInfo(name: "F1", ordinal: 0, widthM: 26, heightM: 20)])
        let positioner = try Positioner(map: map, floor: 0)
        try positioner.hint(hint: Walk.start)
        #expect(try positioner.pushSamples(batch: batchOf(Walk.samples)).count > 50)
    }

    @Test func aPhoneThatIsNotHeldLevelIsWarnedOf() async throws {
        #expect(try await said(of: Walk.samples.compactMap(\.sample)).remedies.isEmpty)
        // The same phone held as to take a picture.
        let upright = Walk.samples.compactMap(\.sample).map { sample -> SensorSample in
            switch sample {
            case .specificForce(let timeNs, let v): .specificForce(timeNs: timeNs, vectorMS2: [v.x, v.z, -v.y])
            case .angularRate(let timeNs, let v): .angularRate(timeNs: timeNs, vectorRadS: [v.x, v.z, -v.y])
            default: sample
            }
        }
        let remedy = try await said(of: upright).remedies.first
        #expect(remedy == "hold the phone level, the screen up and the top edge ahead")
    }

    /// What is said in the middle of a walk in which the phone feels `samples`.
    private func said(of samples: [SensorSample]) async throws -> SurveyState {
        let hand = Hand()
        let walks = SurveyWalks(engine: try engine(), sensors: [hand], nowNs: { hand.nowNs })
        await walks.beginWalk()
        samples.forEach { hand.deliver($0) }
        let state = await walks.look()
        #expect(state.nSteps > 30)
        return state
    }

    @Test func aWalkWithoutStepsSaysWhatToDo() async throws {
        let walks = SurveyWalks(engine: try engine(), sensors: [], nowNs: { 1 })
        await walks.beginWalk()
        await walks.tap(Point2(xM: 5, yM: 5))
        await walks.tap(Point2(xM: -1, yM: 5))
        #expect(await walks.look().message?.contains("plan") == true)
        await walks.endWalk()
        let state = await walks.look()
        #expect(state.nWalks == 0 && state.message?.isEmpty == false)
    }

    @Test func whatIsNoPlanIsRefused() {
        for plan in [Data(), Data("{}".utf8), Data("[1, 2".utf8)] {
            let refused = refusal {
                try newFolder().create(plan: plan, floor: SurveyFolder.Floor(name: "F1", ordinal: 0))
            }
            #expect(refused?.code == "PlanMalformed")
        }
    }

    private func newFolder() -> SurveyFolder {
        SurveyFolder(temporary.url.appendingPathComponent("\(UUID())"))
    }
}

/// Sensors that deliver what they are given.
final class Hand: SensorSource, @unchecked Sendable {
    private var sink: (@Sendable (SensorSample) -> Void)?
    var nowNs: Int64 = 0
    func start(_ deliver: @escaping @Sendable (SensorSample) -> Void) { sink = deliver }
    func stop() { sink = nil }
    func deliver(_ sample: SensorSample) { sink?(sample) }
}

/// A folder that goes with whoever holds it.
final class TemporaryFolder: Sendable {
    let url = FileManager.default.temporaryDirectory.appendingPathComponent("fieldwalk-\(UUID())")
    deinit { try? FileManager.default.removeItem(at: url) }
}
