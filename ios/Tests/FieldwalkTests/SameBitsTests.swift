import Foundation
import Testing

@testable import Fieldwalk

/// What Rust computes and what crosses into Swift is the same, to the bit.
struct SameBitsTests {
    @Test(arguments: [1, 7, 100, 1_000_000])
    func aWalkGivesTheBitsOfFieldwalkReplayWhateverTheSizeOfBatches(batchSize: Int) throws {
        var bits = FixBits()
        let nFixes = try replay(Positioner(map: Walk.openMap(), floor: 0), batchSize, &bits)
        #expect(nFixes > 50)
        try Walk.tell(digest: bits.hex, nFixes: nFixes)
        #expect(bits.hex == Walk.digest)
    }

    @Test func anotherSeedGivesOtherBits() throws {
        var bits = FixBits()
        let positioner = try Positioner(map: Walk.openMap(), floor: 0, options: PositionerOptions(seed: 2))
        _ = try replay(positioner, 100, &bits)
        #expect(bits.hex != Walk.digest)
    }

    /// The same fix and digest stand in cli/src/bits.rs.
    @Test func theDigestOfAFixIsThatOfRust() {
        var bits = FixBits()
        bits.push(
            Fix(
                timeNs: 1_000_000, floor: 0, position: Point2(xM: 1, yM: 2), latitudeLongitude: nil,
                headingRad: 0.5, speedMS: 1, covarianceXxM2: 1, covarianceXyM2: 0, covarianceYyM2: 1,
                radius68M: 1.5, radius95M: 2.5, mode: .particleFilter, attitude: .upwardForwardHorizontal,
                carryMode: .heldUp))
        #expect(bits.hex == "716ca978f0fc2292c308af89090d3f0fe1177a1f151aed465a23722dd4058f29")
    }

    @Test(arguments: ["walk", "kinds"])
    func theEncoderGivesTheBytesOfTheEncoderForRust(name: String) {
        var batch = SampleBatch(capacityBytes: 0)
        Walk.read(name).filter { !$0.isWaypoint }.forEach { $0.add(to: &batch) }
        #expect(batch.bytes == Walk.batch(name))
        batch.removeAll()
        #expect(batch == SampleBatch())
        #expect(batch.bytes.count == 14)
    }

    @Test func samplesOfSensorsArePackedAsTheirRecords() {
        for record in Walk.read("kinds") {
            guard let sample = record.sample else { continue }
            var packed = SampleBatch()
            packed.append(sample)
            #expect(packed.bytes == batchOf([record]), "\(record.kind)")
            #expect(sample.timeNs == record.timeNs)
        }
    }

    @Test func aSnapshotGoesOnToTheSameBits() throws {
        let halves = Walk.samples.chunked(Walk.samples.count / 2 + 1)
        let whole = try Walk.placed()
        _ = try whole.pushSamples(batch: batchOf(halves[0]))
        let restored = try Positioner(map: Walk.openMap(), floor: 0)
        #expect(try restored.fix() == nil)
        try restored.restore(snapshot: whole.snapshot())
        #expect(try restored.fix() == whole.fix())
        let fixes = try whole.pushSamples(batch: batchOf(halves[1]))
        #expect(fixes.count > 20)
        #expect(try restored.pushSamples(batch: batchOf(halves[1])) == fixes)
    }

    @Test func aMapFromBytesGivesTheFixesOfAMapFromFiles() throws {
        let files = try Walk.floorFiles().map { try Data(contentsOf: $0) }
        let fixes = try [Walk.openMap(), BuildingMap.fromFloorFiles(name: "office", files: files)].map { map in
            #expect(map.name() == "office")
            #expect(map.floors() == [FloorInfo(name: "F1", ordinal: 0, widthM: 26, heightM: 20)])
            let positioner = try Positioner(map: map, floor: 0)
            try positioner.hint(hint: Walk.start)
            return try positioner.pushSamples(batch: batchOf(Walk.samples))
        }
        #expect(!fixes[0].isEmpty)
        #expect(fixes[0] == fixes[1])
    }

    /// As `fieldwalk replay` does: a start at the first waypoint, a fix at every step, waypoint and the end.
    private func replay(_ positioner: Positioner, _ batchSize: Int, _ bits: inout FixBits) throws -> Int {
        var fixes: [Fix] = []
        var isStarted = false
        var batch = SampleBatch(capacityBytes: 64)
        func push() throws {
            fixes += try positioner.pushSamples(batch: batch.bytes)
            batch.removeAll()
        }
        for record in Walk.records {
            if !record.isWaypoint {
                record.add(to: &batch)
                if batch.count == batchSize { try push() }
                continue
            }
            try push()
            if !isStarted {
                isStarted = true
                try positioner.hint(hint: Walk.start)
            }
            // Fixes at waypoints in the past of the last sample are not given, here as there.
            if let fix = try positioner.fixAt(timeNs: record.timeNs) { fixes.append(fix) }
        }
        try push()
        try positioner.flush()
        if let fix = try positioner.fix() { fixes.append(fix) }
        fixes.forEach { bits.push($0) }
        return fixes.count
    }

    @Test func theDigestsOfTheStandardAreFound() {
        var digest = Sha256()
        digest.update(Array("abc".utf8))
        #expect(digest.hex == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad")
        var long = Sha256()
        for _ in 0..<1000 { long.update([UInt8](repeating: 0x61, count: 1000)) }
        #expect(long.hex == "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0")
    }
}
