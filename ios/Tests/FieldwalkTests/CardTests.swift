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

    /// The frames that every build of the card's firmware makes; `firmware/golden/README.md` describes them.
    @Test func theGoldenFramesAreReadAsInRust() throws {
        var golden = URL(fileURLWithPath: #filePath)
        for _ in 0..<4 { golden.deleteLastPathComponent() }
        golden.appendPathComponent("firmware/golden")
        let lines = { (name: String) in
            try String(contentsOf: golden.appendingPathComponent(name), encoding: .utf8).split(separator: "\n").map(String.init)
        }
        let decoder = CardDecoder()
        let rounds = try lines("walk-01.frames.txt").map { sent in
            let digits = Array(sent.drop { $0 != " " }.dropFirst())
            let bytes = stride(from: 0, to: digits.count, by: 2).map { UInt8(String(digits[$0...$0 + 1]), radix: 16)! }
            return line(of: try decoder.decodeAdvertisement(advertisement: Data(bytes)))
        }
        #expect(rounds.count == 59)
        #expect(try rounds == lines("walk-01.rounds.txt"))
    }

    private func line(of round: CardRound) -> String {
        let flags = [round.isRepeated, round.isCalibrated, round.justWoke, round.isBatteryLow].map { $0 ? "1" : "0" }
        let thirds = [
            round.verticalFieldUt, round.horizontalFieldUt, round.previousStrengthUt, round.accelerationMaxMS2,
            round.accelerationMinMS2, [round.orientationRad],
        ]
        let bits = thirds.joined().map { value in
            value.map { String($0.bitPattern, radix: 16) }.map { String(repeating: "0", count: 8 - $0.count) + $0 } ?? "-"
        }
        let numbers = ["\(round.cardId)", "\(round.sequence)", round.nLost.map { "\($0)" } ?? "-"]
        return (numbers + flags + [round.batteryMv.map { "\($0)" } ?? "-"] + bits).joined(separator: " ")
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
