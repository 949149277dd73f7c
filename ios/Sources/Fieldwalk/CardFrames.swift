import Foundation

/// The frames of one card as a source of samples: what a session with the system `card` follows.
///
/// ```swift
/// let session = try PositioningSession(
///     map: map, floor: 0, options: PositionerOptions(system: "card"), sensors: [CardScanner().frames(ofCard: 42)])
/// ```
///
/// Sightings of other cards are left out: a session follows one wearer.
public final class CardFrames: SensorSource, @unchecked Sendable {
    private let cardId: UInt16
    private let sightings: @Sendable () -> AsyncStream<CardSighting>
    private let lock = NSLock()
    private var listening: Task<Void, Never>?

    /// - Parameters:
    ///   - cardId: the card's identifier: ``CardSighting/cardId``
    ///   - sightings: called at every start for a stream of what is heard, of any card
    public init(cardId: UInt16, sightings: @escaping @Sendable () -> AsyncStream<CardSighting>) {
        self.cardId = cardId
        self.sightings = sightings
    }

    deinit {
        listening?.cancel()
    }

    public func start(_ deliver: @escaping @Sendable (SensorSample) -> Void) {
        let listening = Task { [cardId, sightings] in
            for await sighting in sightings() where sighting.cardId == cardId {
                deliver(.cardFrame(timeNs: sighting.timeNs, frame: sighting.frame))
            }
        }
        replace(by: listening)
    }

    public func stop() {
        replace(by: nil)
    }

    private func replace(by next: Task<Void, Never>?) {
        let last = lock.withLock {
            defer { listening = next }
            return listening
        }
        last?.cancel()
    }
}
