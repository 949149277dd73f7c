import Fieldwalk
import Foundation

/// The UUIDs that somebody typed, one a line.
///
/// - Throws: ``NoUUIDs`` when a line is none: beacons that iOS is not told of are not heard, and not missed either.
public func beaconUUIDs(in text: String) throws -> [UUID] {
    let lines = text.split(whereSeparator: \.isNewline).map { $0.trimmingCharacters(in: .whitespaces) }
    let typed = lines.filter { !$0.isEmpty }.map { ($0, UUID(uuidString: $0)) }
    let mistyped = typed.filter { $0.1 == nil }.map(\.0)
    guard mistyped.isEmpty else { throw NoUUIDs(lines: mistyped) }
    return typed.compactMap(\.1)
}

/// Lines that are no UUIDs.
public struct NoUUIDs: LocalizedError, Equatable {
    public let lines: [String]

    public var errorDescription: String? {
        let quoted = lines.map { "“\($0)”" }.joined(separator: ", ")
        return "No UUID: \(quoted). One is written as E2C56DB5-DFFB-48D2-B060-D0F5A71096E0, one a line."
    }
}

/// What keeps beacons from being heard.
public enum BeaconTrouble: Sendable {
    /// The user has not allowed the app to use the location.
    case notAuthorized
    /// Bluetooth or location services are off, or the device cannot range.
    case rangingFailed

    /// What to do about it.
    public var remedy: String {
        switch self {
        case .notAuthorized: "no beacons: allow the app to use the location, in the Settings"
        case .rangingFailed: "no beacons: switch Bluetooth and location services on"
        }
    }
}

/// A source of beacons, with what keeps them from being heard: from its report until one is heard, or it starts anew.
public final class BeaconWatch: SensorSource {
    private let source: any SensorSource
    private let last: Last

    /// - Parameter source: makes the source, which is to report to what it is given, from any thread
    public init(_ source: (_ report: @escaping @Sendable (BeaconTrouble) -> Void) -> any SensorSource) {
        let last = Last()
        self.last = last
        self.source = source { last.trouble = $0 }
    }

    /// What keeps beacons from being heard now.
    public var trouble: BeaconTrouble? { last.trouble }

    public func start(_ deliver: @escaping @Sendable (SensorSample) -> Void) throws {
        last.trouble = nil
        try source.start { [last] sample in
            last.trouble = nil
            deliver(sample)
        }
    }

    public func stop() { source.stop() }

    /// Reports and beacons come from any thread.
    private final class Last: @unchecked Sendable {
        private let lock = NSLock()
        private var last: BeaconTrouble?
        var trouble: BeaconTrouble? {
            get { lock.withLock { last } }
            set { lock.withLock { last = newValue } }
        }
    }
}
