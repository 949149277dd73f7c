import Foundation

/// A card heard over Bluetooth.
public struct CardSighting: Sendable, Equatable {
    /// When, on ``SensorClock``.
    public let timeNs: Int64
    /// Received signal strength, in dBm.
    public let rssiDbm: Float
    /// The card's frame as it is on the air, 31 bytes: what ``CardDecoder/decodeAdvertisement(advertisement:)`` reads.
    public let frame: Data

    /// A sighting of what Core Bluetooth calls the manufacturer data; nothing when they are no card's.
    ///
    /// A card's frame is a flags structure and one manufacturer structure. Core Bluetooth hides the first and the head of
    /// the second; both are the same in every frame.
    public init?(manufacturerData: Data, rssiDbm: Int, timeNs: Int64) {
        // 127 is Core Bluetooth's word for unknown.
        guard manufacturerData.count == Self.frameBytes - Self.hiddenHead.count,
            manufacturerData.starts(with: Self.companyId), (-120...20).contains(rssiDbm)
        else { return nil }
        self.timeNs = timeNs
        self.rssiDbm = Float(rssiDbm)
        frame = Data(Self.hiddenHead) + manufacturerData
    }

    /// The identifier of the card that sent it; nothing when the frame is of a version that only a newer build reads.
    public var cardId: UInt16? {
        try? CardDecoder().decodeAdvertisement(advertisement: frame).cardId
    }

    private static let frameBytes = 31
    private static let hiddenHead: [UInt8] = [0x02, 0x01, 0x06, 0x1b, 0xff]
    /// 0xFFFF, little-endian: set aside for tests by the Bluetooth SIG.
    private static let companyId: [UInt8] = [0xff, 0xff]
}
