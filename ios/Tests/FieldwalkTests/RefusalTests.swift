import Foundation
import Testing

@testable import Fieldwalk

/// What is not as it should be is an error of the right case or a count, and changes nothing.
struct RefusalTests {
    @Test func aMapThatIsMissingChangedOrNoneIsToldApart() throws {
        let folder = FileManager.default.temporaryDirectory.appendingPathComponent("fieldwalk-\(UUID())")
        try FileManager.default.createDirectory(at: folder, withIntermediateDirectories: true)
        defer { try? FileManager.default.removeItem(at: folder) }
        let secret = folder.appendingPathComponent("who-lives-here")

        let missing = try #require(refusal { _ = try BuildingMap.open(path: secret.path) })
        guard case .MapNotFound(let explanation, let remedy) = missing else {
            Issue.record("\(missing)")
            return
        }
        #expect(!explanation.isEmpty && !remedy.isEmpty)
        #expect(!missing.localizedDescription.contains("who-lives-here"))

        try FileManager.default.copyItem(at: Walk.mapFolder, to: secret)
        let floor = secret.appendingPathComponent(try #require(Walk.floorFiles().first).lastPathComponent)
        var bytes = try Data(contentsOf: floor)
        bytes[bytes.count - 1] &+= 1
        try bytes.write(to: floor)
        #expect(refusal { _ = try BuildingMap.open(path: secret.path) }?.code == "MapCorrupt")
        #expect(refusal { _ = try BuildingMap.fromFloorFiles(name: "x", files: [bytes]) }?.code == "MapCorrupt")
        let noMap = Data(count: 100)
        #expect(refusal { _ = try BuildingMap.fromFloorFiles(name: "x", files: [noMap]) }?.code == "MapMalformed")
        try Data("{}".utf8).write(to: secret.appendingPathComponent("building.json"))
        #expect(refusal { _ = try BuildingMap.open(path: secret.path) }?.code == "MapMalformed")
    }

    @Test func aMapAsOneFileThatIsCutOrChangedIsRefused() throws {
        let file = try Walk.openMap().export()
        for count in [0, 100, file.count / 2, file.count - 1500] {
            #expect(refusal { _ = try BuildingMap.fromFile(file: file.prefix(count)) }?.code == "MapMalformed", "\(count)")
        }
        var changed = file
        changed[file.count / 2] &+= 1
        #expect(refusal { _ = try BuildingMap.fromFile(file: changed) }?.code == "MapCorrupt")
    }

    @Test func aRecordingThatIsMissingNoneTornOrOfAnotherFloorIsToldApart() throws {
        let folder = FileManager.default.temporaryDirectory.appendingPathComponent("fieldwalk-\(UUID())")
        try FileManager.default.createDirectory(at: folder, withIntermediateDirectories: true)
        defer { try? FileManager.default.removeItem(at: folder) }
        func path(_ name: String) -> String { folder.appendingPathComponent(name).path }
        #expect(refusal { _ = try RecordingReader.open(path: path("none")) }?.code == "RecordingNotFound")
        try Data(count: 50).write(to: URL(fileURLWithPath: path("zeros")))
        // Which format it is of shows as its first part is read.
        let zeros = try RecordingReader.open(path: path("zeros"))
        #expect(refusal { _ = try zeros.nextPart(maxSamples: 1) }?.code == "RecordingMalformed")

        let recorder = try Recorder(path: path("walk"), details: RecordingDetails(floor: "F3"))
        #expect(refusal { _ = try Recorder(path: path("walk")) }?.code == "FileExists")
        try recorder.pushSamples(batch: batchOf(Walk.samples))
        #expect(try recorder.finish().nSamples == UInt64(Walk.samples.count))
        #expect(refusal { try recorder.flush() }?.code == "Finished")
        let plan = try Data(contentsOf: Walk.folder.appendingPathComponent("plan.geojson"))
        let surveyor = try Surveyor(plan: plan, name: "F1", ordinal: 0)
        #expect(refusal { _ = try surveyor.addRecording(path: path("walk"), name: "w") }?.code == "WrongFloor")

        let bytes = try Data(contentsOf: URL(fileURLWithPath: path("walk")))
        try bytes.dropLast(3000).write(to: URL(fileURLWithPath: path("torn")))
        var changed = bytes
        changed[bytes.count / 2] &+= 1
        try changed.write(to: URL(fileURLWithPath: path("changed")))
        let (torn, tornLosses) = try samplesRead(path("torn"))
        #expect(tornLosses.wasCut && torn > Walk.samples.count / 2 && torn <= Walk.samples.count)
        let (whole, losses) = try samplesRead(path("changed"))
        #expect(losses.nCorruptChunks >= 1 && whole < Walk.samples.count)
    }

    private func samplesRead(_ path: String) throws -> (Int, RecordingLosses) {
        let reader = try RecordingReader.open(path: path)
        var n = 0
        while let part = try reader.nextPart(maxSamples: 1000) { n += Int(part.nSamples) }
        return (n, try reader.losses())
    }

    @Test func aFloorOrSystemThatIsNotThereIsRefused() throws {
        let map = try Walk.openMap()
        #expect(refusal { _ = try Positioner(map: map, floor: 7) }?.code == "UnknownFloor")
        let oracle = PositionerOptions(system: "oracle")
        #expect(refusal { _ = try Positioner(map: map, floor: 0, options: oracle) }?.code == "UnknownSystem")
        #expect(systems().contains("fused"))
        #expect(version().split(separator: ".").count >= 3)
    }

    @Test func aHintOfAnotherFloorOrOffThePlanIsRefusedAndChangesNothing() throws {
        let positioner = try Walk.placed()
        let before = try #require(try positioner.fix())
        func hint(_ x: Double, floor: Int32) -> PositionHint {
            PositionHint(point: Point2(xM: x, yM: 1), radiusM: 2, floor: floor, timeNs: 0)
        }
        #expect(refusal { try positioner.hint(hint: hint(1, floor: 3)) }?.code == "WrongFloor")
        let off = try #require(refusal { try positioner.hint(hint: hint(48123.5, floor: 0)) })
        #expect(off.code == "BadHint")
        #expect(!off.localizedDescription.contains("48123"))
        #expect(refusal { try positioner.hint(hint: hint(.nan, floor: 0)) }?.code == "BadHint")
        #expect(try positioner.fix() == before)
    }

    @Test func aTornOrForeignBatchIsRefusedWhole() throws {
        let positioner = try Walk.placed()
        let batch = batchOf(Walk.samples.prefix(500))
        var newer = batch
        newer[4] = 9
        for (bytes, code) in [
            (batch.dropLast(5), "BatchTorn"), (batch + [0], "BatchTorn"), (Data(count: 40), "BatchMalformed"),
            (Data(), "BatchMalformed"), (newer, "BatchTooNew"),
        ] {
            #expect(refusal { _ = try positioner.pushSamples(batch: bytes) }?.code == code)
        }
        #expect(positioner.status().rejections == Rejections(implausible: 0, late: 0, duplicate: 0, jumped: 0))
        #expect(positioner.status().batchFaults == BatchFaults(unknownKind: 0, malformed: 0))
    }

    @Test func badRecordsAndSamplesAreCountedAndCostNoOther() throws {
        let good = try Walk.placed().pushSamples(batch: batchOf(Walk.samples))
        var damaged = SampleBatch()
        Walk.samples.forEach { $0.add(to: &damaged) }
        let lastNs = try #require(Walk.samples.last).timeNs
        damaged.specificForce(timeNs: lastNs + 1, xMS2: .nan, yMS2: 0, zMS2: 0)
        damaged.pressure(timeNs: lastNs + 2, pressureHpa: 1000)
        var bytes = damaged.bytes
        bytes[bytes.count - 14] = 99
        let positioner = try Walk.placed()
        #expect(try positioner.pushSamples(batch: bytes) == good)
        #expect(positioner.status().rejections.implausible == 1)
        #expect(positioner.status().batchFaults == BatchFaults(unknownKind: 1, malformed: 0))
    }

    @Test func thePastAndTheTimeBeforeAStartGiveNoFix() throws {
        let unplaced = try Positioner(map: Walk.openMap(), floor: 0)
        #expect(try unplaced.fix() == nil)
        #expect(try unplaced.fixAt(timeNs: 5) == nil)
        let positioner = try Walk.placed()
        _ = try positioner.pushSamples(batch: batchOf(Walk.samples))
        #expect(refusal { _ = try positioner.fixAt(timeNs: Walk.start.timeNs - 1) }?.code == "TimeInPast")
    }

    @Test func aSnapshotThatIsTornOrOfAnotherSeedIsRefusedAndChangesNothing() throws {
        let positioner = try Walk.placed()
        let snapshot = try positioner.snapshot()
        let before = try positioner.fix()
        for length in [0, 3, 20, snapshot.count - 1] {
            let torn = snapshot.prefix(length)
            #expect(refusal { try positioner.restore(snapshot: torn) }?.code == "SnapshotMalformed", "\(length)")
        }
        let foreign = try Walk.placed(seed: 5).snapshot()
        #expect(refusal { try positioner.restore(snapshot: foreign) }?.code == "SnapshotForeign")
        #expect(try positioner.fix() == before)
    }

    @Test func theEncoderRefusesIdentitiesOfAWrongLength() {
        var batch = SampleBatch()
        #expect(throws: SampleBatch.Refusal.wrongLength(field: "address", expectedBytes: 6)) {
            try batch.bleSighting(timeNs: 0, rssiDbm: -60, address: [1, 2, 3, 4, 5])
        }
        #expect(throws: SampleBatch.Refusal.wrongLength(field: "uuid", expectedBytes: 16)) {
            try batch.ibeaconSighting(timeNs: 0, rssiDbm: -60, uuid: Data(count: 17), major: 1, minor: 1)
        }
        #expect(batch == SampleBatch())
    }
}

/// What the call is refused with, when it is.
func refusal(_ call: () throws -> Void) -> ApiError? {
    do {
        try call()
        return nil
    } catch {
        return error as? ApiError
    }
}

extension ApiError {
    /// The name of the case.
    var code: String { String("\(self)".prefix { $0 != "(" }) }
}
