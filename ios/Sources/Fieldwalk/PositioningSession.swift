import Foundation

/// Follows one wearer on one floor: sensors in, a stream of fixes out.
///
/// ```swift
/// let session = try PositioningSession(map: map, floor: 0, sensors: [MotionSensors()])
/// try await session.hint(tapped)
/// for await fix in try await session.start() { show(fix) }
/// ```
///
/// A session runs while somebody reads its stream: when the loop is left or its task is cancelled, the sensors are
/// stopped. ``start()`` may be called again, and goes on from what was known. All calls may come from any task.
public actor PositioningSession {
    private let positioner: Positioner
    private let sensors: [any SensorSource]
    private let latency: Double
    private var run: SensorRun?
    private var isClosed = false

    /// A session that has seen nothing.
    ///
    /// - Parameters:
    ///   - map: the building; it may be let go afterwards
    ///   - floor: the ordinal of the floor
    ///   - options: the system and seed
    ///   - sensors: where samples come from
    ///   - latency: samples of so long are handed over at once, in seconds; 0.05 by default, fixes are as much later
    /// - Throws: ``ApiError`` when the map has no such floor, and when there is no such system.
    public init(
        map: BuildingMap, floor: Int32, options: PositionerOptions = PositionerOptions(),
        sensors: [any SensorSource], latency: Double = 0.05
    ) throws {
        positioner = try Positioner(map: map, floor: floor, options: options)
        self.sensors = sensors
        self.latency = latency
    }

    deinit {
        run?.end()
    }

    /// Starts, or starts anew, from a place that somebody knows.
    ///
    /// - Throws: ``ApiError`` when the hint is on another floor or not a place on the plan, ``SessionError/closed``.
    public func hint(_ hint: PositionHint) throws {
        try open().hint(hint: hint)
    }

    /// Starts the sensors and gives a fix for every step.
    ///
    /// A reader that lags behind finds the newest 256 fixes. Where nobody reads the earlier stream any more, its sensors
    /// are stopped first.
    ///
    /// - Throws: ``SessionError/alreadyStarted``, ``SessionError/closed``, and what the sensors throw; none of them
    ///   is running then.
    public func start() throws -> AsyncStream<Fix> {
        let positioner = try open()
        if let run {
            guard run.isEnding else { throw SessionError.alreadyStarted }
            // It would stop the sensors that this one starts.
            run.endAndWait()
        }
        let (stream, continuation) = AsyncStream.makeStream(of: Fix.self, bufferingPolicy: .bufferingNewest(256))
        let run = SensorRun(
            sensors: sensors, latency: latency,
            push: { try positioner.pushSamples(batch: $0).forEach { continuation.yield($0) } },
            finish: { _ in
                // A fault of Fieldwalk, the only thing that it throws, shows in every later call too.
                try? positioner.flush()
                continuation.finish()
            })
        run.endWithReader(of: continuation)
        self.run = run
        try run.begin()
        return stream
    }

    /// Stops the sensors and ends the stream; what was known is kept.
    public func stop() {
        run?.end()
    }

    /// Stops for good: later calls throw ``SessionError/closed``. Closing twice is as closing once.
    public func close() {
        isClosed = true
        run?.end()
        run = nil
    }

    /// The fix at the last consumed sample; nothing before a hint or a first step.
    ///
    /// - Throws: ``SessionError/closed``; ``ApiError/Broken(explanation:remedy:)`` after a fault of Fieldwalk itself.
    public func fix() throws -> Fix? {
        try open().fix()
    }

    /// The fix at a time on ``SensorClock``, the open step extrapolated. It changes nothing, so a display may ask as often
    /// as it draws.
    ///
    /// - Throws: ``ApiError/TimeInPast(explanation:remedy:)`` before the last consumed sample, ``SessionError/closed``.
    public func fix(atNs timeNs: Int64) throws -> Fix? {
        try open().fixAt(timeNs: timeNs)
    }

    /// What was left out so far, and why.
    ///
    /// - Throws: ``SessionError/closed``.
    public func status() throws -> Status {
        try open().status()
    }

    /// All that is remembered, to go on from after a restart of the app; for this version of the library only.
    ///
    /// - Throws: ``SessionError/closed``; ``ApiError/Broken(explanation:remedy:)`` after a fault of Fieldwalk itself.
    public func snapshot() throws -> Data {
        try open().snapshot()
    }

    /// Goes on from `snapshot` as if nothing had happened in between.
    ///
    /// - Throws: ``ApiError`` when the bytes are no snapshot or one of another version, system, seed or floor;
    ///   ``SessionError/closed``.
    public func restore(_ snapshot: Data) throws {
        try open().restore(snapshot: snapshot)
    }

    /// Why the stream ended by itself, if it did: a fault of Fieldwalk.
    public func failure() -> (any Error)? {
        run?.failure
    }

    private func open() throws -> Positioner {
        if isClosed { throw SessionError.closed }
        return positioner
    }
}

/// Why a session refused a call.
public enum SessionError: Error, Equatable, Sendable {
    /// It was closed.
    case closed
    /// Its stream is being read already: one session has one reader.
    case alreadyStarted
}
