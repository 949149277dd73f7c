import Foundation

@testable import Fieldwalk

/// The digest that `fieldwalk replay --bits` prints, of fixes as Swift sees them; defined in cli/src/bits.rs.
struct FixBits {
    private var digest = Sha256()

    mutating func push(_ fix: Fix) {
        append(fix.timeNs)
        append(fix.floor)
        let place = fix.latitudeLongitude
        let numbers = [
            fix.position.xM, fix.position.yM, fix.headingRad, fix.speedMS,
            fix.covarianceXxM2, fix.covarianceXyM2, fix.covarianceXyM2, fix.covarianceYyM2,
            fix.radius68M, fix.radius95M,
            place?.latitudeDeg ?? .nan, place?.longitudeDeg ?? .nan,
        ]
        // One NaN for all.
        numbers.forEach { append($0.isNaN ? 0x7ff8_0000_0000_0000 : $0.bitPattern) }
        let mode: UInt8 =
            switch fix.mode {
            case .started: 0
            case .particleFilter: 1
            case .stale: 2
            case .beacon: 3
            case .paused: 4
            case .other: 255
            }
        append(mode)
        let attitude: UInt8 =
            switch fix.attitude {
            case .unknown: 0
            case .upwardForwardHorizontal: 1
            case .upwardForwardInclined: 2
            case .upwardNotForward: 3
            case .notUpward: 4
            }
        append(attitude)
        let carryMode: UInt8 =
            switch fix.carryMode {
            case .unknown: 0
            case .heldUp: 1
            case .heldUpright: 2
            case .calling: 3
            case .swinging: 4
            case .frontPocket: 5
            case .backPocket: 6
            case .onTable: 7
            }
        append(carryMode)
    }

    var hex: String { digest.hex }

    private mutating func append(_ number: some FixedWidthInteger) {
        withUnsafeBytes(of: number.littleEndian) { digest.update($0) }
    }
}

/// SHA-256 (FIPS 180-4): Foundation has none on Linux.
struct Sha256 {
    private var state: [UInt32] = [
        0x6a09_e667, 0xbb67_ae85, 0x3c6e_f372, 0xa54f_f53a, 0x510e_527f, 0x9b05_688c, 0x1f83_d9ab, 0x5be0_cd19,
    ]
    private var pending: [UInt8] = []
    private var nBytes: UInt64 = 0

    mutating func update(_ bytes: some Collection<UInt8>) {
        pending += bytes
        nBytes += UInt64(bytes.count)
        while pending.count >= 64 {
            compress(Array(pending.prefix(64)))
            pending.removeFirst(64)
        }
    }

    var hex: String {
        var last = self
        let zeros = (119 - Int(nBytes % 64)) % 64
        let length = withUnsafeBytes(of: (nBytes * 8).bigEndian) { Array($0) }
        last.update([0x80] + [UInt8](repeating: 0, count: zeros) + length)
        return last.state.map { word in
            let digits = String(word, radix: 16)
            return String(repeating: "0", count: 8 - digits.count) + digits
        }.joined()
    }

    private mutating func compress(_ block: [UInt8]) {
        func turned(_ x: UInt32, _ n: UInt32) -> UInt32 { x >> n | x << (32 - n) }
        var w = (0..<16).map { k in block[4 * k..<4 * k + 4].reduce(UInt32(0)) { $0 << 8 | UInt32($1) } }
        for k in 16..<64 {
            let s0 = turned(w[k - 15], 7) ^ turned(w[k - 15], 18) ^ w[k - 15] >> 3
            let s1 = turned(w[k - 2], 17) ^ turned(w[k - 2], 19) ^ w[k - 2] >> 10
            w.append(w[k - 16] &+ s0 &+ w[k - 7] &+ s1)
        }
        var v = state
        for k in 0..<64 {
            let s1 = turned(v[4], 6) ^ turned(v[4], 11) ^ turned(v[4], 25)
            let choice = (v[4] & v[5]) ^ (~v[4] & v[6])
            let t1 = v[7] &+ s1 &+ choice &+ Self.constants[k] &+ w[k]
            let s0 = turned(v[0], 2) ^ turned(v[0], 13) ^ turned(v[0], 22)
            let majority = (v[0] & v[1]) ^ (v[0] & v[2]) ^ (v[1] & v[2])
            v = [t1 &+ s0 &+ majority, v[0], v[1], v[2], v[3] &+ t1, v[4], v[5], v[6]]
        }
        for k in 0..<8 { state[k] = state[k] &+ v[k] }
    }

    /// The first 32 bits of the fractional parts of the cube roots of the first 64 primes.
    private static let constants: [UInt32] = {
        let primes = (2...311).filter { n in (2..<n).allSatisfy { n % $0 != 0 } }
        return primes.map { prime in
            // The cube root times 2^32, by bisection in integers.
            var low: UInt64 = 0, high: UInt64 = 8 << 32
            while high - low > 1 {
                let middle = (low + high) / 2
                let square = middle.multipliedFullWidth(by: middle)
                // middle³ against prime · 2^96, both cut to multiples of 2^64.
                let cube = square.high.multipliedFullWidth(by: middle)
                let carry = square.low.multipliedFullWidth(by: middle).high
                let (low64, overflow) = cube.low.addingReportingOverflow(carry)
                let isAbove =
                    cube.high + (overflow ? 1 : 0) > 0 || low64 >= UInt64(prime) << 32
                if isAbove { high = middle } else { low = middle }
            }
            return UInt32(truncatingIfNeeded: low)
        }
    }()
}
