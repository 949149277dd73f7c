import Foundation

/// From a start to its end: samples of all sensors, packed and pushed.
///
/// The sensors' threads do the work themselves, one at a time, so that nothing is queued between them and the engine.
package final class SensorRun: @unchecked Sendable {
    private let sensors: [any SensorSource]
    private let latencyNs: Int64
    private let push: @Sendable (Data) throws -> Void
    private let finish: @Sendable ((any Error)?) -> Void

    /// Guards what follows.
    private let lock = NSLock()
    private var batch = SampleBatch()
    private var firstNs: Int64?
    private var ending = false
    private var error: (any Error)?

    /// Guards what follows. Nothing is called while it is held: a task that is cancelled asks for it under its own lock.
    private let condition = NSCondition()
    private var left = false
    private var over = false

    /// - Parameters:
    ///   - latency: samples of so long are handed over at once, in seconds, 0 to 1
    ///   - push: takes a batch, one at a time; when it throws, the run ends
    ///   - finish: called once when the run has ended, with what `push` threw
    package init(
        sensors: [any SensorSource], latency: Double, push: @escaping @Sendable (Data) throws -> Void,
        finish: @escaping @Sendable ((any Error)?) -> Void
    ) {
        self.sensors = sensors
        latencyNs = SensorClock.timeNs(secondsSinceBoot: min(max(latency, 0), 1))
        self.push = push
        self.finish = finish
    }

    /// Whether it ends now or has ended, or will in a moment since nobody reads its stream.
    package var isEnding: Bool { condition.withLock { left } || lock.withLock { ending } }
    /// Whether its sensors have stopped.
    package var isOver: Bool { condition.withLock { over } }
    package var failure: (any Error)? { lock.withLock { error } }

    /// Starts every sensor, or none.
    package func begin() throws {
        do {
            for sensor in sensors {
                // A sensor that outlives the run holds nothing of it.
                try sensor.start { [weak self] sample in self?.take(sample) }
            }
        } catch {
            end()
            throw error
        }
    }

    /// Pushes what was delivered and not pushed yet.
    package func flush() {
        lock.withLock { pushBatch() }
    }

    /// Stops the sensors and pushes what is left; once.
    ///
    /// While another thread does so it does not wait: that thread may wait for this one, which delivers.
    package func end() {
        let isFirst = lock.withLock {
            if ending { return false }
            pushBatch()
            ending = true
            return true
        }
        guard isFirst else { return }
        // Outside the lock: both may wait for a thread that is about to deliver.
        sensors.forEach { $0.stop() }
        finish(failure)
        condition.withLock {
            over = true
            condition.broadcast()
        }
    }

    /// As ``end()``, and waits until the sensors have stopped, whoever stops them: not for a thread that delivers.
    package func endAndWait() {
        end()
        condition.withLock {
            while !over { condition.wait() }
        }
    }

    /// Ends the run, soon, when nobody reads the stream of `continuation` any more.
    package func endWithReader<Element>(of continuation: AsyncStream<Element>.Continuation) {
        continuation.onTermination = { [weak self] _ in
            // Not here: a task that is cancelled holds its own lock now, a sensor that delivers meanwhile holds the run's,
            // and each would wait for the other.
            guard let self else { return }
            condition.withLock { self.left = true }
            DispatchQueue.global().async { self.end() }
        }
    }

    private func take(_ sample: SensorSample) {
        let hasFailed = lock.withLock {
            if ending { return false }
            let firstNs = self.firstNs ?? sample.timeNs
            self.firstNs = firstNs
            batch.append(sample)
            // A frame is a whole second's, and the next comes a second later.
            let isFrame = if case .cardFrame = sample { true } else { false }
            // Far apart either way; times may be any numbers.
            if isFrame || sample.timeNs.subtractingReportingOverflow(firstNs).partialValue.magnitude >= latencyNs.magnitude {
                pushBatch()
            }
            return error != nil
        }
        if hasFailed { end() }
    }

    /// Under the lock.
    private func pushBatch() {
        guard batch.count > 0, error == nil else { return }
        do { try push(batch.bytes) } catch { self.error = error }
        batch.removeAll()
        firstNs = nil
    }
}
