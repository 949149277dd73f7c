import Foundation
import Testing

@testable import Fieldwalk

/// A session: sensors in, a stream of fixes out, and nothing left behind.
struct SessionTests {
    private func session(_ sensors: [any SensorSource], latency: Double = 0.05) throws -> PositioningSession {
        try PositioningSession(map: Walk.openMap(), floor: 0, sensors: sensors, latency: latency)
    }

    @Test(arguments: [0, 0.05, 1])
    func theStreamHasTheFixesOfAllSamplesPushedAtOnce(latency: Double) async throws {
        var batch = SampleBatch()
        Walk.samples.compactMap(\.sample).forEach { batch.append($0) }
        let expected = try Walk.placed().pushSamples(batch: batch.bytes)
        #expect((51...256).contains(expected.count))
        let sensors = RecordedSensors()
        let session = try session([sensors], latency: latency)
        try await session.hint(Walk.start)
        let stream = try await session.start()
        #expect(await eventually { sensors.nRunning == 0 })
        await session.stop()
        var fixes: [Fix] = []
        for await fix in stream { fixes.append(fix) }
        #expect(fixes == expected)
        #expect(await session.failure() == nil)
        #expect(try await session.fix() != nil)
    }

    @Test func aLoopThatIsLeftStopsTheSensorsAndMayBeginAgain() async throws {
        let sensors = RecordedSensors(isRepeating: true)
        let session = try session([sensors])
        try await session.hint(Walk.start)
        for k in 1...3 {
            // Where the loop is left nobody holds the stream any more.
            try await readOne(of: session)
            #expect(await eventually { sensors.nRunning == 0 })
            #expect(sensors.nStarts == k)
            try await session.hint(Walk.start)
        }
    }

    private func readOne(of session: PositioningSession) async throws {
        for await fix in try await session.start() {
            #expect(fix.floor == 0)
            break
        }
    }

    @Test func aCancelledTaskStopsTheSensors() async throws {
        let sensors = RecordedSensors(isRepeating: true)
        let session = try session([sensors])
        try await session.hint(Walk.start)
        let stream = try await session.start()
        let reader = Task { for await _ in stream {} }
        #expect(await eventually { sensors.nRunning == 1 })
        reader.cancel()
        await reader.value
        #expect(await eventually { sensors.nRunning == 0 })
    }

    /// The earlier run ends on another thread, and is slow at it.
    @Test func startingRightAfterTheReaderIsGoneMeetsNothingOfTheEarlierRun() async throws {
        let sensors = SlowToStop()
        let session = try session([sensors])
        let n = 200
        for _ in 0..<n {
            let stream = try await session.start()
            let reader = Task { for await _ in stream {} }
            reader.cancel()
            await reader.value
            // And a stream that nobody holds.
            _ = try await session.start()
        }
        let stream = try await session.start()
        #expect(sensors.isRunning)
        await #expect(throws: SessionError.alreadyStarted) { _ = try await session.start() }
        await session.stop()
        for await _ in stream {}
        #expect(sensors.log == String(repeating: "+-", count: 2 * n + 1))
    }

    @Test func aRunIsOverWhenItsSensorsHaveStopped() async throws {
        let sensors = SlowToStop()
        let run = SensorRun(sensors: [sensors], latency: 0, push: { _ in throw CancellationError() }, finish: { _ in })
        try run.begin()
        Thread.detachNewThread { sensors.deliver(.pressure(timeNs: 0, hpa: 1000)) }
        #expect(await eventually { run.isEnding })
        if run.isOver { #expect(!sensors.isRunning) }
        run.endAndWait()
        #expect(run.isOver && !sensors.isRunning && sensors.log == "+-")
        #expect(run.failure is CancellationError)
    }

    /// Otherwise the two would wait for each other: the sensor's thread holds the run and wants to wake the task, which is being
    /// cancelled and wants the run to end.
    @Test func aCancellationDoesNotWaitForASensorThatDelivers() async throws {
        let (stream, continuation) = AsyncStream.makeStream(of: Int.self)
        let (isReading, isCancelled, didNotWait) = (Flag(), Flag(), Flag())
        let reader = Task { for await _ in stream { isReading.raise() } }
        continuation.yield(0)
        #expect(await eventually { isReading.isRaised })
        let sensors = RecordedSensors([.pressure(timeNs: 0, hpa: 1000)])
        let run = SensorRun(
            sensors: [sensors], latency: 0,
            push: { _ in
                // A sensor delivers; meanwhile, on another thread, the task is cancelled. Half a minute is for a busy machine.
                Thread.detachNewThread {
                    reader.cancel()
                    isCancelled.raise()
                }
                for _ in 0..<3000 where !isCancelled.isRaised { Thread.sleep(forTimeInterval: 0.01) }
                guard isCancelled.isRaised else { return }
                didNotWait.raise()
                continuation.yield(1)
            },
            finish: { _ in continuation.finish() })
        run.endWithReader(of: continuation)
        try run.begin()
        await reader.value
        #expect(await eventually { run.isOver && sensors.nRunning == 0 })
        #expect(didNotWait.isRaised)
    }

    @Test func aSessionThatNobodyHoldsStopsItsSensors() async throws {
        let sensors = RecordedSensors(isRepeating: true)
        var session: PositioningSession? = try session([sensors])
        let stream = try await session?.start()
        #expect(await eventually { sensors.nRunning == 1 })
        session = nil
        #expect(await eventually { sensors.nRunning == 0 })
        if let stream { for await _ in stream {} }
    }

    @Test func oneSessionHasOneReader() async throws {
        let session = try session([RecordedSensors(isRepeating: true)])
        let stream = try await session.start()
        await #expect(throws: SessionError.alreadyStarted) { _ = try await session.start() }
        await session.stop()
        for await _ in stream {}
        _ = try await session.start()
        await session.close()
    }

    @Test func useAfterCloseIsAnError() async throws {
        let sensors = RecordedSensors(isRepeating: true)
        let session = try session([sensors])
        let stream = try await session.start()
        await session.close()
        await session.close()
        for await _ in stream {}
        #expect(await eventually { sensors.nRunning == 0 })
        await #expect(throws: SessionError.closed) { _ = try await session.start() }
        await #expect(throws: SessionError.closed) { try await session.hint(Walk.start) }
        await #expect(throws: SessionError.closed) { _ = try await session.fix() }
        await #expect(throws: SessionError.closed) { _ = try await session.fix(atNs: 1) }
        await #expect(throws: SessionError.closed) { _ = try await session.status() }
        await #expect(throws: SessionError.closed) { _ = try await session.snapshot() }
        await #expect(throws: SessionError.closed) { try await session.restore(Data()) }
    }

    @Test func aSensorThatIsMissingStartsNone() async throws {
        let sensors = RecordedSensors(isRepeating: true)
        let session = try session([sensors, MissingSensor()])
        await #expect(throws: MissingSensor.Missing.self) { _ = try await session.start() }
        #expect(await eventually { sensors.nRunning == 0 })
        // Not "already started".
        await #expect(throws: MissingSensor.Missing.self) { _ = try await session.start() }
    }

    @Test func timesThatAreNoneAreCountedAndHarmNothing() async throws {
        let odd: [SensorSample] = [.min, .max, 0, .max, .min].map { .pressure(timeNs: $0, hpa: 1000) }
        let sensors = RecordedSensors(odd)
        let session = try session([sensors])
        let stream = try await session.start()
        #expect(await eventually { sensors.nRunning == 0 })
        await session.stop()
        for await _ in stream {}
        #expect(await session.failure() == nil)
        let rejections = try await session.status().rejections
        #expect(rejections.late + rejections.duplicate + rejections.jumped > 0)
    }

    @Test func whatWasKnownOutlivesTheSession() async throws {
        let sensors = RecordedSensors()
        let first = try session([sensors])
        try await first.hint(Walk.start)
        let stream = try await first.start()
        #expect(await eventually { sensors.nRunning == 0 })
        await first.stop()
        for await _ in stream {}
        let snapshot = try await first.snapshot()
        let fix = try await first.fix()
        await first.close()
        let second = try session([])
        #expect(try await second.fix() == nil)
        try await second.restore(snapshot)
        #expect(try await second.fix() == fix)
        let later = try #require(fix).timeNs + 1_000_000_000
        #expect(try await second.fix(atNs: later)?.timeNs == later)
    }

    @Test func theExampleOfTheReadmeFollowsAWalk() async throws {
        let sensors = RecordedSensors(isRepeating: true)
        let following = Task {
            try await follow(mapFolder: Walk.mapFolder.path, sensors: [sensors], tapped: Walk.start)
        }
        #expect(await eventually { sensors.nRunning == 1 })
        following.cancel()
        try await following.value
        #expect(await eventually { sensors.nRunning == 0 })
    }
}

/// Sensors that take a while to stop, and write down in which order they were started and stopped.
private final class SlowToStop: SensorSource, @unchecked Sendable {
    private let lock = NSLock()
    private var sink: (@Sendable (SensorSample) -> Void)?
    private var calls = ""

    /// A plus for each start, a minus for each stop.
    var log: String { lock.withLock { calls } }
    var isRunning: Bool { lock.withLock { sink != nil } }

    func start(_ deliver: @escaping @Sendable (SensorSample) -> Void) {
        lock.withLock {
            sink = deliver
            calls += "+"
        }
    }

    func stop() {
        Thread.sleep(forTimeInterval: 0.002)
        lock.withLock {
            sink = nil
            calls += "-"
        }
    }

    func deliver(_ sample: SensorSample) {
        let sink = lock.withLock { self.sink }
        sink?(sample)
    }
}
