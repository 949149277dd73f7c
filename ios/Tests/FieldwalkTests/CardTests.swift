import Foundation
import Testing

@testable import Fieldwalk

/// Cards heard by a scanner, followed by a session.
struct CardTests {
    /// The walk as a card at the walker's chest would have told it.
    private let frames = Walk.read("card")
    private let options = PositionerOptions(system: "card")

    @Test func aSessionFollowsOneCardAmongOthers() async throws {
        let expected = try fixesOfFrames()
        #expect(expected.count > 20)
        let own = try frames.map { try sighting(of: $0) }
        let cardId = try #require(own.first?.cardId)
        // Another card's frames at the same instants, whose identifier alone is another.
        let heard = own.flatMap { [$0, other($0)] }
        #expect(Set(heard.map(\.cardId)).count == 2)
        let source = CardFrames(cardId: cardId) {
            AsyncStream { continuation in
                heard.forEach { continuation.yield($0) }
                continuation.finish()
            }
        }
        let session = try PositioningSession(map: Walk.openMap(), floor: 0, options: options, sensors: [source])
        try await session.hint(Walk.start)
        let stream = try await session.start()
        var fixes: [Fix] = []
        for await fix in stream {
            fixes.append(fix)
            // Every frame is pushed when it comes: the last fix needs no sample after it.
            if fixes.count == expected.count { break }
        }
        #expect(fixes == expected)
        await session.close()
    }

    @Test func aStoppedSourceHearsNoMore() async throws {
        let first = try sighting(of: #require(frames.first))
        let ended = Flag()
        let source = CardFrames(cardId: try #require(first.cardId)) {
            AsyncStream { continuation in
                continuation.onTermination = { _ in ended.raise() }
                continuation.yield(first)
            }
        }
        let heard = Flag()
        source.start { _ in heard.raise() }
        #expect(await eventually { heard.isRaised })
        source.stop()
        #expect(await eventually { ended.isRaised })
    }

    private func fixesOfFrames() throws -> [Fix] {
        let positioner = try Positioner(map: Walk.openMap(), floor: 0, options: options)
        try positioner.hint(hint: Walk.start)
        return try frames.flatMap { try positioner.pushSamples(batch: batchOf([$0])) }
    }

    private func sighting(of record: Record) throws -> CardSighting {
        guard case .cardFrame(let timeNs, let frame) = try #require(record.sample) else {
            throw CocoaError(.formatting)
        }
        return try #require(CardSighting(manufacturerData: frame.dropFirst(5), rssiDbm: -60, timeNs: timeNs))
    }

    private func other(_ sighting: CardSighting) -> CardSighting {
        var manufacturer = Data(sighting.frame.dropFirst(5))
        // The identifier's second byte.
        manufacturer[6] ^= 1
        return CardSighting(manufacturerData: manufacturer, rssiDbm: -60, timeNs: sighting.timeNs) ?? sighting
    }
}

/// Raised once, on any thread.
private final class Flag: @unchecked Sendable {
    private let lock = NSLock()
    private var raised = false
    func raise() { lock.withLock { raised = true } }
    var isRaised: Bool { lock.withLock { raised } }
}
