import Foundation
import Testing

@testable import Fieldwalk

/// Objects on several threads, made and let go many times. One test at a time: they look at the whole process.
@Suite(.serialized)
struct LifetimeTests {
    @Test func twoTasksOnOnePositionerTakeTurnsAndLoseNothing() async throws {
        // Half a minute: a task that comes a whole minute after the other would pass for a clock that was set back.
        let samples = Walk.samples.prefix(Walk.samples.count / 2)
        let batches = Array(samples).chunked(50).map { batchOf($0) }
        let positioner = try Walk.placed()
        // All that both push is the same: of each sample one copy is taken, the other refused.
        let nFixes = try await withThrowingTaskGroup(of: Int.self) { group in
            for _ in 0..<2 {
                group.addTask { try batches.reduce(0) { try $0 + positioner.pushSamples(batch: $1).count } }
            }
            return try await group.reduce(0, +)
        }
        let rejections = positioner.status().rejections
        #expect(nFixes > 20)
        #expect(rejections.duplicate + rejections.late == UInt64(samples.count))
    }

    @Test func twoPositionersOnOneMapDoNotDisturbEachOther() async throws {
        let map = try Walk.openMap()
        let batches = Walk.samples.chunked(100).map { batchOf($0) }
        let fixes = try await withThrowingTaskGroup(of: [Fix].self) { group in
            for _ in 0..<2 {
                group.addTask {
                    let positioner = try Positioner(map: map, floor: 0)
                    try positioner.hint(hint: Walk.start)
                    return try batches.flatMap { try positioner.pushSamples(batch: $0) }
                }
            }
            return try await group.reduce(into: []) { $0.append($1) }
        }
        #expect(fixes[0].count > 50)
        #expect(fixes[0] == fixes[1])
    }

    @Test func aPositionerOutlivesItsMap() throws {
        var map: BuildingMap? = try Walk.openMap()
        let positioner = try Positioner(map: #require(map), floor: 0)
        map = nil
        try positioner.hint(hint: Walk.start)
        #expect(try positioner.fix() != nil)
    }

    #if os(Linux)
        @Test func tenThousandSessionsLeaveNoMemoryThreadOrFileBehind() async throws {
            let map = try Walk.openMap()
            let samples = Walk.samples.prefix(40).compactMap(\.sample)
            func cycles(_ n: Int) async throws {
                for _ in 0..<n {
                    let session = try PositioningSession(map: map, floor: 0, sensors: [ImmediateSensors(samples)])
                    try await session.hint(Walk.start)
                    let stream = try await session.start()
                    await session.stop()
                    for await _ in stream {}
                    #expect(try await session.fix() != nil)
                    await session.close()
                }
            }
            try await cycles(100)
            let before = ProcessUse.now()
            // A session with its particles takes about 100 kB: of one kept of a hundred three times would be 15 MB.
            try await expectFlatMemory { try await cycles(5000) }
            let after = ProcessUse.now()
            // The pool may grow to the number of cores while other tests run beside.
            #expect(after.nThreads <= before.nThreads + ProcessInfo.processInfo.activeProcessorCount)
            #expect(after.nFiles <= before.nFiles)
        }

        @Test func tenThousandObjectsLeaveNoMemoryThreadOrFileBehind() async throws {
            let map = try Walk.openMap()
            let batch = batchOf(Walk.samples.prefix(60))
            let file = FileManager.default.temporaryDirectory.appendingPathComponent("fieldwalk-\(UUID()).mcap")
            defer { try? FileManager.default.removeItem(at: file) }
            let recorder = try Recorder(path: file.path)
            try recorder.pushSamples(batch: batch)
            _ = try recorder.finish()
            func cycles(_ n: Int) throws {
                for _ in 0..<n {
                    let positioner = try Positioner(map: map, floor: 0)
                    try positioner.hint(hint: Walk.start)
                    _ = try positioner.pushSamples(batch: batch)
                    try positioner.flush()
                    #expect(try positioner.fix() != nil)
                    try MagnetometerCalibrator().pushSamples(batch: batch)
                    #expect(try RecordingReader.open(path: file.path).nextPart(maxSamples: 1000)?.nSamples == 60)
                    _ = CardDecoder()
                }
            }
            try cycles(100)
            let before = ProcessUse.now()
            try await expectFlatMemory { try cycles(5000) }
            let after = ProcessUse.now()
            #expect(after.nThreads <= before.nThreads + ProcessInfo.processInfo.activeProcessorCount)
            #expect(after.nFiles <= before.nFiles)
        }
    #endif
}

/// Samples delivered within `start`.
private struct ImmediateSensors: SensorSource {
    let samples: [SensorSample]
    init(_ samples: [SensorSample]) { self.samples = samples }
    func start(_ deliver: @escaping @Sendable (SensorSample) -> Void) { samples.forEach(deliver) }
    func stop() {}
}

#if os(Linux)
    /// Repeats `use` until three times in a row have added less than 4 MB together: a leak takes more each time, whereas what
    /// the allocator and the pool of threads keep comes to an end.
    private func expectFlatMemory(_ use: () async throws -> Void) async throws {
        var heldBytes: [Int] = []
        for _ in 0..<9 {
            try await use()
            heldBytes.append(ProcessUse.now().residentBytes)
            if let before = heldBytes.dropLast(3).last, heldBytes[heldBytes.count - 1] < before + (4 << 20) { return }
        }
        Issue.record("memory grows: \(heldBytes)")
    }

    /// What the process holds.
    private struct ProcessUse {
        let residentBytes: Int
        let nThreads: Int
        let nFiles: Int

        static func now() -> Self {
            let pages = try! String(contentsOfFile: "/proc/self/statm", encoding: .utf8).split(separator: " ")
            func count(_ folder: String) -> Int { try! FileManager.default.contentsOfDirectory(atPath: folder).count }
            return Self(
                residentBytes: Int(pages[1])! * sysconf(Int32(_SC_PAGESIZE)), nThreads: count("/proc/self/task"),
                nFiles: count("/proc/self/fd"))
        }
    }
#endif
