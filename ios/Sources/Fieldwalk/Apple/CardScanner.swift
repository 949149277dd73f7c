#if canImport(CoreBluetooth)
    import CoreBluetooth
    import Foundation

    /// Cards near the phone, heard over Core Bluetooth, in the foreground only.
    ///
    /// A card advertises no service, and iOS scans for none but named services in the background: there this hears
    /// nothing. The app's Info.plist needs `NSBluetoothAlwaysUsageDescription`.
    public final class CardScanner: Sendable {
        /// What keeps cards from being heard.
        public enum Trouble: Error, Equatable, Sendable {
            /// The user has not allowed the app to use Bluetooth; the app's settings change that.
            case notAuthorized
            /// Bluetooth is switched off.
            case poweredOff
            /// The device has no Bluetooth of this kind.
            case unsupported
        }

        private let report: @Sendable (Trouble) -> Void

        /// - Parameter report: called on a queue of the scanner's own with what keeps cards from being heard
        public init(report: @escaping @Sendable (Trouble) -> Void = { _ in }) {
            self.report = report
        }

        /// Every frame heard, until the loop over them is left or its task is cancelled.
        public func sightings() -> AsyncStream<CardSighting> {
            let (stream, continuation) = AsyncStream.makeStream(
                of: CardSighting.self, bufferingPolicy: .bufferingNewest(256))
            let scan = Scan(report: report, continuation: continuation)
            scan.begin()
            continuation.onTermination = { _ in scan.end() }
            return stream
        }

        /// The frames of one card, for a session with the system `card`.
        public func frames(ofCard cardId: UInt16) -> CardFrames {
            CardFrames(cardId: cardId) { self.sightings() }
        }
    }

    /// On its queue only, which Core Bluetooth calls back on.
    private final class Scan: NSObject, CBCentralManagerDelegate, @unchecked Sendable {
        private let queue = DispatchQueue(label: "org.fieldwalk.cards")
        private let report: @Sendable (CardScanner.Trouble) -> Void
        private let continuation: AsyncStream<CardSighting>.Continuation
        private var central: CBCentralManager?

        init(
            report: @escaping @Sendable (CardScanner.Trouble) -> Void,
            continuation: AsyncStream<CardSighting>.Continuation
        ) {
            self.report = report
            self.continuation = continuation
        }

        func begin() {
            queue.async { self.central = CBCentralManager(delegate: self, queue: self.queue) }
        }

        func end() {
            queue.async {
                self.central?.stopScan()
                self.central?.delegate = nil
                self.central = nil
            }
        }

        func centralManagerDidUpdateState(_ central: CBCentralManager) {
            switch central.state {
            case .poweredOn:
                // With duplicates: a card's frame changes every second, and iOS would report it once.
                central.scanForPeripherals(
                    withServices: nil, options: [CBCentralManagerScanOptionAllowDuplicatesKey: true])
            case .poweredOff:
                report(.poweredOff)
            case .unauthorized:
                report(.notAuthorized)
            case .unsupported:
                report(.unsupported)
            default:
                break
            }
        }

        func centralManager(
            _ central: CBCentralManager, didDiscover peripheral: CBPeripheral,
            advertisementData: [String: Any], rssi RSSI: NSNumber
        ) {
            guard let bytes = advertisementData[CBAdvertisementDataManufacturerDataKey] as? Data,
                let sighting = CardSighting(
                    manufacturerData: bytes, rssiDbm: RSSI.intValue, timeNs: SensorClock.nowNs())
            else { return }
            continuation.yield(sighting)
        }
    }
#endif
