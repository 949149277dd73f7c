import Foundation

public enum CBManagerState: Int, Sendable {
    case unknown, resetting, unsupported, unauthorized, poweredOff, poweredOn
}

public let CBAdvertisementDataManufacturerDataKey = "kCBAdvDataManufacturerData"
public let CBCentralManagerScanOptionAllowDuplicatesKey = "kCBScanOptionAllowDuplicates"

open class CBUUID: NSObject {}
open class CBPeripheral: NSObject {}

open class CBCentralManager: NSObject {
    public weak var delegate: (any CBCentralManagerDelegate)?
    public var state: CBManagerState { .unknown }
    public init(delegate: (any CBCentralManagerDelegate)?, queue: DispatchQueue?) {}
    public func scanForPeripherals(withServices serviceUUIDs: [CBUUID]?, options: [String: Any]?) {}
    public func stopScan() {}
}

/// Optional in Objective-C but for the first; here every method must be written, so that a misspelt one is found.
public protocol CBCentralManagerDelegate: AnyObject {
    func centralManagerDidUpdateState(_ central: CBCentralManager)
    func centralManager(
        _ central: CBCentralManager, didDiscover peripheral: CBPeripheral,
        advertisementData: [String: Any], rssi RSSI: NSNumber)
}
