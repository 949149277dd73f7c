import Foundation

@testable import Fieldwalk

/// The walk's samples, delivered on a thread of their own as fast as they are taken.
final class RecordedSensors: SensorSource, @unchecked Sendable {
    private let samples: [SensorSample]
    private let isRepeating: Bool
    private let lock = NSLock()
    private var generation = 0
    private var starts = 0
    private var running = 0

    /// - Parameter isRepeating: go on with samples of the last instant when all are delivered, as a phone at rest
    init(_ samples: [SensorSample] = Walk.samples.compactMap(\.sample), isRepeating: Bool = false) {
        self.samples = samples
        self.isRepeating = isRepeating
    }

    var nStarts: Int { lock.withLock { starts } }
    /// Threads that have not ended.
    var nRunning: Int { lock.withLock { running } }

    func start(_ deliver: @escaping @Sendable (SensorSample) -> Void) {
        let own = lock.withLock {
            generation += 1
            starts += 1
            running += 1
            return generation
        }
        Thread.detachNewThread { [self] in
            deliverAll(deliver) { self.lock.withLock { self.generation == own } }
            lock.withLock { running -= 1 }
        }
    }

    func stop() {
        lock.withLock { generation += 1 }
    }

    private func deliverAll(_ deliver: (SensorSample) -> Void, isWanted: () -> Bool) {
        for sample in samples where isWanted() { deliver(sample) }
        guard isRepeating, var timeNs = samples.last?.timeNs else { return }
        while isWanted() {
            timeNs += 10_000_000
            deliver(.specificForce(timeNs: timeNs, vectorMS2: SIMD3(0, 0, 9.8)))
            Thread.sleep(forTimeInterval: 0.001)
        }
    }
}

/// A sensor that the device does not have.
struct MissingSensor: SensorSource {
    struct Missing: Error {}
    func start(_ deliver: @escaping @Sendable (SensorSample) -> Void) throws { throw Missing() }
    func stop() {}
}

/// Waits until `condition` holds; a minute is for a machine that does much else.
func eventually(_ condition: () -> Bool) async -> Bool {
    for _ in 0..<6000 {
        if condition() { return true }
        try? await Task.sleep(nanoseconds: 10_000_000)
    }
    return false
}

/// Raised once, on any thread.
final class Flag: @unchecked Sendable {
    private let lock = NSLock()
    private var raised = false
    func raise() { lock.withLock { raised = true } }
    var isRaised: Bool { lock.withLock { raised } }
}
