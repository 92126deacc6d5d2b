-- SPDX-License-Identifier: Apache-2.0
-- Tactus sessions in Wireshark and tshark (tested with 4.0.17): spec/70-session.md, and of packets what 25 and 40 let read without state.
--
-- Install: copy this file into the folder "Personal Lua Plugins" (Help, About Wireshark, Folders), or give it on the command line:
--   tshark -X lua_script:tools/wireshark/tactus.lua -r session.pcap
-- A session is found by its join or welcome on any UDP port. If the capture begins later: port 7447 (a preference), or "Decode As".
-- Then checks stay unverified and numbers are shown as they are on the wire.
-- Sealed sessions are shown inside DTLS if Wireshark has the secrets (SSLKEYLOGFILE, preference tls.keylog_file) and decrypts the cipher:
-- 4.0.17 does so for AES, but not for ChaCha20-Poly1305 in DTLS.
--
-- Filters:   tactus.ack.newest   tactus.packet.key == 1   tactus.check.status == "bad"   tactus.rule   tactus.part.type == 4
-- Fields in [brackets] are computed from the conversation, as seen where the capture was taken: tactus.number (not modulo 2^14),
-- tactus.ack.frame (the datagram that is acknowledged), tactus.ack.sample (70, section 7), tactus.packet.baseline, tactus.packet.tick.
local VERSION = 1
local END_OF_TIME, END_OF_TICKS = 2 ^ 53, 2 ^ 32
local FARTHEST_OFFSET = 2 ^ 34 -- as zigzag
local LARGEST, PIECE, FRAGMENT = 1200, 1024, 1150
local HANDSHAKE, PARTS, PACKET = 0, 1, 2
local JOIN, WELCOME, REFUSAL, LEAVE = 0, 1, 2, 3
local ACK, CLOCK, BUTTONS, PIECES, STATE, HASH, FRAGMENTS, PACKETS = 1, 2, 3, 4, 5, 6, 7, 8
local TICK_MAPPING = BUTTONS -- down
local UP, DOWN = 0, 1
local MOST_EPOCHS = 8 -- of a conversation that checks are tried for, the newest ones

local tactus = Proto("tactus", "Tactus session")
tactus.prefs.port = Pref.uint("UDP port of servers", 7447, "For captures that begin after the join")

-- ---- Fields and rules ------------------------------------------------------------------------------------------------
local forms = { [0] = "handshake", "parts", "packet", "reserved" }
local kinds = { [0] = "join", "welcome", "refusal", "leave" }
local part_names = { "acknowledgement", "clock", "buttons or tick mapping", "piece or report", "state or seat", "hash or baselines", "fragment", "packet" }
local reasons = { [0] = "bye", "version", "full", "limits", "silence", "scene", "protocol" }
local statuses = { [0] = "bad", "good", "unverified" }
local directions = { [0] = "up", "down" }
local roles = { [0] = "observer", "participant" }
local types = {}
for i, name in ipairs(part_names) do types[i] = name end
for i = 64, 255 do types[i] = "for later or private use" end

local f, list = {}, {}
local function field(name, make, text, ...)
  f[name] = make("tactus." .. name, text, ...)
  list[#list + 1] = f[name]
end
local u8, u16, u32, u64, raw = ProtoField.uint8, ProtoField.uint16, ProtoField.uint32, ProtoField.uint64, ProtoField.bytes
field("direction", u8, "Direction", base.DEC, directions)
field("form", u16, "Form", base.DEC, forms, 0x0003)
field("kind", u16, "Kind", base.DEC, kinds, 0xfffc)
field("value", u16, "Number modulo 2^14", base.DEC, nil, 0xfffc)
field("number", u64, "Number", base.DEC)
field("epoch", u64, "Epoch", base.HEX)
field("check", u32, "Check (CRC-32)", base.HEX)
field("check.status", u8, "Check status", base.DEC, statuses)
field("magic", ProtoField.string, "Magic")
field("version", u8, "Version")
field("role", u8, "Role", base.DEC, roles)
field("nonce", u64, "Nonce", base.HEX)
field("token", u64, "Token of the session to go on with", base.HEX)
field("seat", u8, "Seat, from 1")
field("state_limit", u64, "State limit [bytes]", base.DEC)
field("header_limit", u64, "Declaration limit [bytes]", base.DEC)
field("padding", raw, "Zeros")
field("serial", u64, "Serial of the epoch", base.DEC)
field("client", u16, "Client")
field("size", u64, "Declaration size [bytes]", base.DEC)
field("hash", u64, "Declaration hash (FNV-1a)", base.HEX)
field("start", u64, "Server's clock at tick 0 [us]", base.DEC)
field("world", u64, "What is simulated", base.HEX)
field("reason", u8, "Reason", base.DEC, reasons)
field("part", ProtoField.none, "Part")
field("part.type", u8, "Type", base.DEC, types)
field("part.size", u64, "Size [bytes]", base.DEC)
field("part.data", raw, "Data")
field("ack.newest", u16, "Newest number accepted, modulo 2^16")
field("ack.number", u64, "Newest number accepted", base.DEC)
field("ack.frame", ProtoField.framenum, "Acknowledges the datagram in", base.NONE, frametype.ACK)
field("ack.held", u16, "Held [16 us]")
field("ack.held_us", u32, "Held [us]")
field("ack.missing", u64, "Missing, bit i: number newest - 1 - i", base.HEX)
field("ack.missing_count", u8, "Missing datagrams")
field("ack.sample", u64, "Round trip from here, without the hold time [us]", base.DEC)
field("clock.time", u64, "Server's clock [us]", base.DEC)
field("buttons.tick", u32, "Since tick of the device")
field("buttons.mask", u32, "Buttons that are down", base.HEX)
field("tick_mapping.from", u64, "From this tick of the server on", base.DEC)
field("tick_mapping.offset", ProtoField.int64, "Ticks of the server less those of the device", base.DEC)
field("piece.index", u64, "Index", base.DEC)
field("piece.data", raw, "Bytes of the declaration")
field("piece.received", u64, "Bytes of the declaration so far", base.DEC)
field("baselines.policy", u8, "What packets down build on", base.DEC, { [0] = "the packet before", "acknowledged packets" })
field("report.delay", u64, "Playout delay [ms]", base.DEC)
field("report.key", u8, "Wants a key packet")
field("state.live", u8, "Live: holds the declaration, wants packets")
field("hash.substream", u8, "Substream")
field("hash.number", u16, "Packet number modulo 2^16")
field("hash.hash", u32, "Low 32 bits of the state hash", base.HEX)
field("back", u64, "Back: packet's number below the datagram's", base.DEC)
field("fragment.substream", u64, "Substream", base.DEC)
field("fragment.index", u64, "Index", base.DEC)
field("fragment.count", u64, "Fragments of the packet", base.DEC)
field("fragment.data", raw, "Bytes of the packet")
field("packet", raw, "Packet")
field("packet.number", u64, "Packet number", base.DEC)
field("packet.substream", u8, "Substream")
field("packet.key", u8, "Key packet")
field("packet.baseline_delta", u64, "Baseline delta", base.DEC)
field("packet.baseline", u64, "Baseline: state after packet number", base.DEC)
field("packet.tick_delta", u64, "Ticks since the baseline's", base.DEC)
field("packet.tick", u64, "Tick", base.DEC)
field("rule", ProtoField.string, "Rule broken")
tactus.fields = list

local expert_of, rule_text, experts = {}, {}, {}
local function new_expert(name, text, group, severity)
  local made = ProtoExpert.new(name, text, group, severity)
  experts[#experts + 1] = made
  return made
end
local MALFORMED, SEQUENCE, CHECKSUM = expert.group.MALFORMED, expert.group.SEQUENCE, expert.group.CHECKSUM
local ERROR, WARN, NOTE = expert.severity.ERROR, expert.severity.WARN, expert.severity.NOTE
for rule, e in pairs({
  { "the check does not hold for this epoch and direction (70, section 2)", CHECKSUM, ERROR },
  { "form, kind, direction or size is not permitted (70, section 2)", MALFORMED, ERROR },
  { "an element is cut or too long, or something follows (70, section 2)", MALFORMED, ERROR },
  { "the number was seen before, or is more than 1023 below the newest (70, section 4)", SEQUENCE, NOTE },
  { "order, type or direction of a part (70, section 2)", MALFORMED, ERROR },
  { "acknowledges a datagram that was not seen here (70, section 4)", SEQUENCE, WARN },
  { "elements of the fragment are out of range (70, section 5)", MALFORMED, ERROR },
  { "the piece is not in the declaration, or not of its size (70, section 6)", MALFORMED, ERROR },
  { "magic, version or role is not known (70, section 3)", expert.group.PROTOCOL, ERROR },
  { "the hash of the declaration is not that of the welcome (70, section 6)", CHECKSUM, ERROR },
}) do
  local name = "R-SES-" .. rule
  rule_text[name] = name .. ": " .. e[1]
  expert_of[name] = new_expert("tactus.rule.ses" .. rule, name, e[2], e[3])
end
local cut_short = new_expert("tactus.cut", "The capture holds only a part of the datagram", expert.group.UNDECODED, NOTE)
tactus.experts = experts

local function breaks(tree, rule, detail)
  tree:add(f.rule, rule):set_generated()
  tree:add_proto_expert_info(expert_of[rule], rule_text[rule] .. (detail and ": " .. detail or ""))
end

-- ---- Numbers and checks (10) -----------------------------------------------------------------------------------------
local bits = bit32 or load([[ return { -- Lua 5.3 and later
  bxor = function(a, b) return a ~ b end, band = function(a, b) return a & b end, rshift = function(a, n) return a >> n end } ]])()
local floor = math.floor
local crc_table = {}
for i = 0, 255 do
  local c = i
  for _ = 1, 8 do c = bits.band(c, 1) == 1 and bits.bxor(bits.rshift(c, 1), 0xedb88320) or bits.rshift(c, 1) end
  crc_table[i] = c
end

local function crc32(text)
  local c = 0xffffffff
  for i = 1, #text do c = bits.bxor(bits.rshift(c, 8), crc_table[bits.band(bits.bxor(c, text:byte(i)), 0xff)]) end
  return bits.bxor(c, 0xffffffff)
end

-- FNV-1a, lower and upper half; the factor is 2^40 + 435.
local function fnv1a(text)
  local low, high = 0x84222325, 0xcbf29ce4
  for i = 1, #text do
    low = bits.bxor(low, text:byte(i))
    local product = low * 435
    high = (high * 435 + floor(product / 2 ^ 32) + low % 2 ^ 24 * 256) % 2 ^ 32
    low = floor(product % 2 ^ 32)
  end
  return low, high
end

local NO_EPOCH = ("\0"):rep(8)
local function is_of(bytes, epoch, direction)
  local a, b, c, d = bytes:byte(-4, -1)
  return d ~= nil and crc32(epoch .. string.char(direction) .. bytes:sub(1, -5)) == a + 256 * (b + 256 * (c + 256 * d))
end

-- Elements of a datagram, one after the other. After the first that is cut or a varint that is wrong, `broken` stays set.
local Reader = {}
Reader.__index = Reader
local function reader(tvb, at, stop) return setmetatable({ tvb = tvb, at = at, stop = stop }, Reader) end
function Reader:left() return self.broken and 0 or self.stop - self.at end
function Reader:take(size)
  if self.broken or size > self.stop - self.at then
    self.broken = true
    return nil
  end
  local range = self.tvb:range(self.at, size)
  self.at = self.at + size
  return range
end
-- A varint as its range, its value as a double, and its 64 bits (10, section 4).
function Reader:varint()
  local from, low, middle, high = self.at, 0, 0, 0
  for i = 0, 9 do
    local range = self:take(1)
    if not range then return nil end
    local byte = range:uint()
    local digit = byte % 128
    if i < 4 then low = low + digit * 128 ^ i
    elseif i < 8 then middle = middle + digit * 128 ^ (i - 4)
    else high = high + digit * 128 ^ (i - 8) end
    if byte < 128 then
      if (byte == 0 and i > 0) or high > 255 then break end
      local value = low + 2 ^ 28 * middle + 2 ^ 56 * high
      local exact = UInt64.new(floor(low + 2 ^ 28 * (middle % 16)), floor(floor(middle / 16) + 2 ^ 24 * high))
      return self.tvb:range(from, self.at - from), floor(value), exact
    end
  end
  self.broken = true
end
function Reader:add(tree, name, size)
  local range = self:take(size)
  if range then tree:add_le(f[name], range) end
  return range
end
function Reader:add_varint(tree, name)
  local range, value, exact = self:varint()
  if range then tree:add(f[name], range, exact) end
  return value
end

-- ---- What is remembered of conversations -----------------------------------------------------------------------------
local conversations, frames
local function forget() conversations, frames = {}, {} end
tactus.init = forget
forget()

local function conversation_of(pinfo)
  local a = tostring(pinfo.src) .. " " .. pinfo.src_port
  local b = tostring(pinfo.dst) .. " " .. pinfo.dst_port
  local key = a < b and a .. " " .. b or b .. " " .. a
  conversations[key] = conversations[key] or { epochs = {} }
  return conversations[key], a, b
end

local function direction_of(pinfo, conversation, from, to)
  if conversation.client then return conversation.client == from and UP or DOWN end
  if pinfo.dst_port == tactus.prefs.port then return UP end
  if pinfo.src_port == tactus.prefs.port then return DOWN end
  return pinfo.src_port > pinfo.dst_port and UP or DOWN -- servers mostly have the lower port
end

-- #M, number of substreams and whether number 0 is one of them, from the bytes of a declaration (20).
local function substreams_of(declaration)
  local at = 24
  local function varint()
    local value, scale = 0, 1
    for _ = 1, 4 do
      local byte = declaration:byte(at) or 0
      at, value, scale = at + 1, value + byte % 128 * scale, scale * 128
      if byte < 128 then break end
    end
    return value
  end
  local span, objects, moving = declaration:byte(23), varint(), 0
  for _ = 1, objects do
    local dof, size = declaration:byte(at + 1), declaration:byte(at + 2)
    if not size then return nil end
    moving, at = moving + (dof > 0 and 1 or 0), at + 3 + size + 28
  end
  local deformable = (declaration:byte(7) or 0) % 2 == 1 and varint() or 0
  local rigid = moving > 0 or deformable == 0
  return { span = span, moving = moving, count = (rigid and 1 or 0) + deformable, rigid = rigid }
end

-- 70, section 4.
local function extend(epoch, direction, value)
  local newest = epoch.newest[direction]
  return newest + (value + 12287 - newest) % 16384 - 12287
end

-- ---- Packets (25, section 2; 40, section 2) --------------------------------------------------------------------------
-- Each model is used at most once up to tick_delta, so that start values are enough (spec/tables/rigid-start-models.csv).
local KEY = { 32092 }
local BASELINE = {}
for i = 1, 15 do BASELINE[i] = 16384 end
local TICK = { 29936, 1818, 29159, 10248, 20136, 16001, 9493, 64, 6366, 10949, 23927, 18158, 32704, 179, 14753 }

local Range = {}
Range.__index = Range
local function range_decoder(bytes)
  local d = setmetatable({ bytes = bytes, at = 0, range = 2 ^ 32 - 1, code = 0 }, Range)
  for _ = 1, 4 do d.code = d.code * 256 + d:next() end
  return d
end
function Range:next()
  self.at = self.at + 1
  return self.bytes:byte(self.at) or 0
end
function Range:normalise()
  while self.range < 2 ^ 24 do self.code, self.range = (self.code * 256 + self:next()) % 2 ^ 32, self.range * 256 end
end
function Range:bit(zero)
  local bound, value = floor(self.range / 2 ^ 15) * zero, 0
  if self.code < bound then self.range = bound
  else value, self.code, self.range = 1, self.code - bound, self.range - bound end
  self:normalise()
  return value
end
function Range:raw(n)
  local step, last = floor(self.range / 2 ^ n), 2 ^ n - 1
  local value = math.min(floor(self.code / step), last)
  self.code = self.code - value * step
  self.range = value == last and self.range - value * step or step
  self:normalise()
  return value
end
function Range:magnitude(models)
  local node = 1
  for _ = 1, 4 do node = 2 * node + self:bit(models[node]) end
  local w = node - 16
  if w == 15 then w = 15 + self:raw(5) end
  if w < 2 then return w end
  if w > 32 then return nil end
  local value, left = 1, w - 1
  while left > 0 do
    local n = math.min(left, 16)
    left, value = left - n, value * 2 ^ n + self:raw(n)
  end
  return floor(value)
end

local function generated(tree, name, range, value)
  tree:add(f[name], range, UInt64.new(floor(value % 2 ^ 32), floor(value / 2 ^ 32))):set_generated()
end

-- Adds a packet, and returns a word on it. `number` is nil if it is not known.
local function add_packet(tree, range, epoch, direction, number, fresh)
  tree:add(f.packet, range)
  if number then generated(tree, "packet.number", range, number) end
  local scene = direction == UP and { span = 64, count = 1, rigid = true } or epoch and epoch.scene
  if not scene then return "packet" end
  local substream, payload = scene.rigid and 0 or 1, range
  if scene.count > 1 then
    if range:len() < 1 then return "packet" end
    tree:add(f["packet.substream"], range(0, 1))
    substream = range(0, 1):uint()
    payload = range:len() > 1 and range(1) or nil
  end
  if substream > 0 then return "packet of object " .. substream end
  local decoder = range_decoder(payload and payload:len() > 0 and payload:raw() or "")
  local key = decoder:bit(KEY[1])
  local delta = 1
  if key == 0 and scene.span > 1 then delta = decoder:magnitude(BASELINE) end
  local ticks = delta and decoder:magnitude(TICK)
  tree:add(f["packet.key"], range, key):set_generated()
  if not ticks then return "packet" end
  if key == 0 then generated(tree, "packet.baseline_delta", range, delta) end
  local baseline = key == 0 and number and number > delta and number - delta
  if baseline then generated(tree, "packet.baseline", range, baseline) end
  generated(tree, "packet.tick_delta", range, ticks)
  if epoch and number then
    local known = epoch.ticks[direction]
    local before = key == 1 and 0 or known[number - delta]
    if fresh and before and not known[number] then known[number] = before + ticks end
    if before then generated(tree, "packet.tick", range, before + ticks) end
  end
  return key == 1 and "key packet" or baseline and "packet on " .. baseline or "packet"
end

-- ---- Parts (section 2) -----------------------------------------------------------------------------------------------
local add_part = {}

add_part[ACK] = function(r, tree, d)
  local newest_range = r:add(tree, "ack.newest", 2)
  local held_range = r:add(tree, "ack.held", 2)
  local at, _, missing = r:varint()
  if not at then return "ack" end
  tree:add(f["ack.missing"], at, missing)
  local held, count = held_range:le_uint(), 0
  for _, left in ipairs({ missing:lower(), missing:higher() }) do
    while left > 0 do left, count = floor(left / 2), count + left % 2 end
  end
  tree:add(f["ack.missing_count"], at, count):set_generated()
  if held < 65535 then tree:add(f["ack.held_us"], held_range, 16 * held):set_generated() end
  local word = "ack " .. newest_range:le_uint() .. (count > 0 and " without " .. count or "")
  if not d.number then return word end
  local newest_sent = d.epoch.newest[1 - d.direction]
  if d.fresh then
    local back = (newest_sent - newest_range:le_uint()) % 65536
    local number = newest_sent - back
    local sent = number > 0 and d.epoch.seen[1 - d.direction][number]
    d.memory.ack = sent and { number = number, frame = sent.frame }
    if sent and held < 65535 and number > d.epoch.acknowledged[d.direction] then
      d.memory.ack.sample = math.max(0, floor((d.time - sent.time) * 1e6 + 0.5) - 16 * held)
    end
    if sent then d.epoch.acknowledged[d.direction] = math.max(d.epoch.acknowledged[d.direction], number) end
  end
  local ack = d.memory.ack
  if not ack then
    breaks(tree, "R-SES-6")
    return word
  end
  generated(tree, "ack.number", newest_range, ack.number)
  tree:add(f["ack.frame"], newest_range, ack.frame):set_generated()
  if ack.sample then generated(tree, "ack.sample", newest_range, ack.sample) end
  return "ack " .. ack.number .. (count > 0 and " without " .. count or "")
end

add_part[CLOCK] = function(r, tree)
  if (r:add_varint(tree, "clock.time") or 0) >= END_OF_TIME then r.broken = true end
  return "clock"
end

add_part[BUTTONS] = function(r, tree, d)
  if d.direction == UP then
    r:add(tree, "buttons.tick", 4)
    r:add(tree, "buttons.mask", 4)
    return "buttons"
  end
  local from, range, zigzag = r:add_varint(tree, "tick_mapping.from"), r:varint()
  if not zigzag then return "tick mapping" end
  if from >= END_OF_TICKS or zigzag > FARTHEST_OFFSET then
    r.broken = true
    return "tick mapping"
  end
  local offset = zigzag % 2 == 0 and zigzag / 2 or -(zigzag + 1) / 2
  tree:add(f["tick_mapping.offset"], range, Int64.new(floor(offset)))
  return string.format("tick mapping from %.0f, offset %.0f", from, offset)
end

add_part[PIECES] = function(r, tree, d)
  if d.direction == UP then
    r:add_varint(tree, "report.delay")
    local key = r:add(tree, "report.key", 1)
    if key and key:uint() > 1 then r.broken = true end
    return "report"
  end
  local index = r:add_varint(tree, "piece.index")
  if not index then return "piece" end
  local data = r:take(r:left())
  if data and data:len() > 0 then tree:add(f["piece.data"], data) end
  local epoch, size = d.number and d.epoch, data and data:len() or 0
  if not epoch then return "piece " .. index end
  if index * PIECE >= epoch.size or size ~= math.min(PIECE, epoch.size - index * PIECE) then
    breaks(tree, "R-SES-8")
    return "piece " .. index
  end
  if d.fresh then
    if not epoch.pieces[index] then
      epoch.pieces[index], epoch.received = data:raw(), epoch.received + size
      if epoch.received == epoch.size then
        local all = {}
        for i = 0, floor((epoch.size - 1) / PIECE) do all[#all + 1] = epoch.pieces[i] end
        local declaration = table.concat(all)
        local low, high = fnv1a(declaration)
        d.memory.wrong_hash = low ~= epoch.hash:lower() or high ~= epoch.hash:higher()
        epoch.scene = not d.memory.wrong_hash and substreams_of(declaration) or nil
      end
    end
    d.memory.received = epoch.received
  end
  generated(tree, "piece.received", data, d.memory.received or 0)
  if d.memory.wrong_hash then breaks(tree, "R-SES-10") end
  return "piece " .. index .. " of " .. floor((epoch.size + PIECE - 1) / PIECE)
end

add_part[STATE] = function(r, tree, d)
  if d.direction == DOWN then
    local seat = r:add(tree, "seat", 1)
    return "seat " .. (seat and seat:uint() or "")
  end
  local live = r:add(tree, "state.live", 1)
  if live and live:uint() > 1 then r.broken = true end
  return live and live:uint() == 1 and "live" or "not live"
end

add_part[HASH] = function(r, tree, d)
  if d.direction == DOWN then
    local policy = r:add(tree, "baselines.policy", 1)
    if policy and policy:uint() > 1 then r.broken = true end
    return "baselines"
  end
  r:add(tree, "hash.substream", 1)
  r:add(tree, "hash.number", 2)
  r:add(tree, "hash.hash", 4)
  return "hash"
end

add_part[FRAGMENTS] = function(r, tree, d)
  local back = r:add_varint(tree, "back")
  r:add_varint(tree, "fragment.substream")
  local index, count = r:add_varint(tree, "fragment.index"), r:add_varint(tree, "fragment.count")
  if not count then return "fragment" end
  local data = r:take(r:left())
  local size = data and data:len() or 0
  if size > 0 then tree:add(f["fragment.data"], data) end
  local fits = size == FRAGMENT or (size > 0 and size < FRAGMENT and index == count - 1)
  local sound = count >= 2 and count <= 1024 and index < count and fits
  if not sound or (d.number and back >= d.number) then breaks(tree, "R-SES-7")
  elseif d.number then generated(tree, "packet.number", data, d.number - back) end
  return "fragment " .. index .. " of " .. count
end

add_part[PACKETS] = function(r, tree, d)
  local back = r:add_varint(tree, "back")
  if not back then return "packet" end
  local number = d.number and back < d.number and d.number - back or nil
  local range = r:left() > 0 and r:take(r:left()) or d.tvb:range(r.at, 0)
  return add_packet(tree, range, d.epoch, d.direction, number, d.fresh)
end

local only = { [CLOCK] = DOWN }

local function add_parts(tree, d)
  local r, last, words = reader(d.tvb, 2, d.stop), 0, {}
  local fragment, alone = false, false
  if r:left() == 0 then breaks(tree, "R-SES-5", "no part") end
  while r:left() > 0 do
    local from = r.at
    local type_range = r:take(1)
    local size_range, size, exact = r:varint()
    if not size_range or size > r:left() then
      breaks(tree, "R-SES-3")
      break
    end
    local kind = type_range:uint()
    local part = tree:add(f.part, d.tvb:range(from, r.at + size - from))
    local names = kind == TICK_MAPPING and { "buttons", "tick mapping" } or kind == PIECES and { "report", "piece" } or kind == STATE and { "state", "seat" } or
      kind == HASH and { "hash", "baselines" } or {}
    part:append_text(": " .. (names[d.direction == UP and 1 or 2] or types[kind] or "reserved"))
    part:add(f["part.type"], type_range)
    part:add(f["part.size"], size_range, exact)
    if kind < last or kind == 0 or (kind > 8 and kind < 64) or (only[kind] and only[kind] ~= d.direction) or
      (kind == FRAGMENTS or kind == PACKETS) and fragment then
      breaks(part, "R-SES-5")
      break
    end
    fragment, last = fragment or kind == FRAGMENTS, kind
    local inner = reader(d.tvb, r.at, r.at + size)
    if add_part[kind] then
      alone = #words == 0 and kind == PACKETS and size > 0 and d.tvb:range(r.at, 1):uint() == 0
      words[#words + 1] = add_part[kind](inner, part, d)
      if inner.broken or inner:left() > 0 then
        breaks(part, "R-SES-3")
        break
      end
    else
      words[#words + 1] = "type " .. kind
      if size > 0 then part:add(f["part.data"], d.tvb:range(r.at, size)) end
    end
    r.at = r.at + size
  end
  if alone and #words == 1 then breaks(tree, "R-SES-5", "a single packet of the datagram's own number has form 2") end
  return table.concat(words, ", ")
end

-- ---- Handshakes (section 3) ------------------------------------------------------------------------------------------
local add_handshake = {}

add_handshake[JOIN] = function(r, tree, d)
  local magic = r:take(4)
  if not magic then return "join" end
  tree:add(f.magic, magic)
  local version, role = r:add(tree, "version", 1), r:add(tree, "role", 1)
  if not role then return "join" end
  local known = version:uint() == VERSION
  if magic:raw() ~= "TCTS" or known and role:uint() > 1 then breaks(tree, "R-SES-9") end
  local nonce = r:add(tree, "nonce", 8)
  if nonce and not known and d.size >= 80 then  -- the server answers that it does not speak it
    r:take(r:left())
    return "join of version " .. version:uint()
  end
  r:add(tree, "token", 8)
  r:add(tree, "seat", 1)
  r:add_varint(tree, "state_limit")
  r:add_varint(tree, "header_limit")
  local zeros = r:left() > 0 and r:take(r:left())
  if zeros then tree:add(f.padding, zeros) end
  if d.size < 80 or zeros and zeros:raw():find("[^%z]") then r.broken = true end
  if d.fresh and nonce then d.conversation.client = d.from end
  return "join as " .. (roles[role:uint()] or role:uint())
end

add_handshake[WELCOME] = function(r, tree, d)
  r:add(tree, "nonce", 8)
  local serial = r:add_varint(tree, "serial")
  local epoch, client = r:add(tree, "epoch", 8), r:add(tree, "client", 2)
  local size = r:add_varint(tree, "size")
  local hash = r:add(tree, "hash", 8)
  if (r:add_varint(tree, "start") or 0) >= END_OF_TIME then r.broken = true end
  r:add(tree, "world", 8)
  if r.broken then return "welcome" end
  local epochs, key = d.conversation.epochs, epoch:raw()
  if d.fresh then d.conversation.client = d.to end
  if d.fresh and not epochs[key] then
    epochs[key] = { key = key, id = epoch:le_uint64(), size = size, hash = hash:le_uint64(), received = 0, pieces = {},
                    newest = { [UP] = 0, [DOWN] = 0 }, acknowledged = { [UP] = 0, [DOWN] = 0 },
                    seen = { [UP] = {}, [DOWN] = {} }, ticks = { [UP] = {}, [DOWN] = {} } }
    table.insert(epochs, 1, epochs[key])
    if #epochs > MOST_EPOCHS then epochs[table.remove(epochs).key] = nil end
  end
  return string.format("welcome, client %d, epoch %.0f, declaration of %.0f bytes", client:le_uint(), serial, size)
end

local function add_reason(r, tree)
  local reason = r:add(tree, "reason", 1)
  if reason and not reasons[reason:uint()] then r.broken = true end
  return reason and (reasons[reason:uint()] or reason:uint()) or "?"
end

add_handshake[REFUSAL] = function(r, tree)
  r:add(tree, "nonce", 8)
  return "refusal, " .. add_reason(r, tree)
end

add_handshake[LEAVE] = function(r, tree) return "leave, " .. add_reason(r, tree) end

-- ---- Datagrams (section 2) -------------------------------------------------------------------------------------------
-- The check's status, and the epoch for which it holds; with a direction that was only guessed, the other one is tried, too.
local function look_at_check(bytes, d, kind)
  if kind == JOIN or kind == WELCOME or kind == REFUSAL then
    return is_of(bytes, NO_EPOCH, d.direction) and 1 or 0
  end
  for _, epoch in ipairs(d.conversation.epochs) do
    if is_of(bytes, epoch.key, d.direction) then return 1, epoch end
  end
  return #d.conversation.epochs > 0 and 0 or 2
end

-- What is computed when a datagram is seen first; later looks at it must not change the conversation.
local function remember(d, bytes, form, value)
  local kind = form == HANDSHAKE and value or nil
  local memory = { direction = d.direction }
  if not d.conversation.client then -- a handshake's kind says more than its ports
    if kind == JOIN then memory.direction = UP elseif kind == WELCOME or kind == REFUSAL then memory.direction = DOWN end
  end
  d.direction = memory.direction
  memory.status, memory.epoch = look_at_check(bytes, d, kind)
  local epoch = memory.epoch
  if epoch and (form == PARTS or form == PACKET) then
    memory.number = extend(epoch, d.direction, value)
    local seen = epoch.seen[d.direction]
    memory.stale = memory.number < 1 or memory.number <= epoch.newest[d.direction] - 1024 or seen[memory.number] ~= nil
    if not memory.stale then
      seen[memory.number] = { frame = d.frame, time = d.time }
      epoch.newest[d.direction] = math.max(epoch.newest[d.direction], memory.number)
    end
  end
  return memory
end

local function add_body(tree, tvb, d, form, value)
  local direction = d.direction == UP and "up   " or "down "
  if form == HANDSHAKE and kinds[value] then
    local comes = value == LEAVE or (value == JOIN) == (d.direction == UP)
    d.fresh = d.fresh and comes
    local r = reader(tvb, 2, d.stop)
    local word = add_handshake[value](r, tree, d)
    if not comes then breaks(tree, "R-SES-2") end
    if r.broken or r:left() > 0 then breaks(tree, "R-SES-3") end
    return direction .. word
  elseif form == PARTS or form == PACKET then
    local head = direction .. "#" .. (d.number or value .. "?") .. " "
    if form == PARTS then return head .. add_parts(tree, d) end
    return head .. add_packet(tree, tvb:range(2, d.stop - 2), d.epoch, d.direction, d.number, d.fresh)
  end
  breaks(tree, "R-SES-2")
  return direction .. "unknown form or kind"
end

local function dissect(tvb, pinfo, root)
  local size = tvb:len()
  pinfo.cols.protocol = "Tactus"
  local tree = root:add(tactus, tvb())
  if tvb:reported_len() > size then
    pinfo.cols.info = "cut by the capture"
    tree:add_proto_expert_info(cut_short)
    return size
  end
  if size < 6 or size > LARGEST then
    pinfo.cols.info = "not a datagram of a session"
    breaks(tree, "R-SES-1", size .. " bytes")
    return size
  end
  local conversation, from, to = conversation_of(pinfo)
  local d = { tvb = tvb, size = size, stop = size - 4, conversation = conversation, from = from, to = to,
              frame = pinfo.number, time = pinfo.rel_ts, direction = direction_of(pinfo, conversation, from, to) }
  local head = tvb:range(0, 2)
  local form, value = head:le_uint() % 4, floor(head:le_uint() / 4)
  local key = pinfo.number .. " " .. tvb:range(size - 4, 4):uint()
  local memory = frames[key]
  d.fresh = memory == nil
  if d.fresh then
    memory = remember(d, tvb:raw(), form, value)
    frames[key] = memory
  end
  d.memory, d.direction = memory, memory.direction
  d.epoch = memory.epoch
  d.fresh = d.fresh and memory.status == 1 and not memory.stale
  d.number = not memory.stale and memory.number or nil

  tree:add(f.direction, tvb:range(0, 0), d.direction):set_generated()
  tree:add_le(f.form, head)
  if form == HANDSHAKE then tree:add_le(f.kind, head) else tree:add_le(f.value, head) end
  if memory.number and memory.number > 0 then generated(tree, "number", head, memory.number) end
  if memory.stale then breaks(tree, "R-SES-4") end
  local word = add_body(tree, tvb, d, form, value)
  local check = tvb:range(size - 4, 4)
  tree:add_le(f.check, check)
  tree:add(f["check.status"], check, memory.status):set_generated()
  if memory.epoch then tree:add(f.epoch, check, memory.epoch.id):set_generated() end
  if memory.status == 0 then breaks(tree, "R-SES-1") end
  word = word .. (memory.stale and " (again or old)" or "") .. (memory.status == 0 and " [bad check]" or "")
  pinfo.cols.info = word
  tree:append_text(", " .. word:gsub("^(%S+) +", "%1 "))
  return size
end
-- ---- Where it is called ----------------------------------------------------------------------------------------------
-- A handshake whose check holds: one foreign datagram in 2^32 passes.
local function is_handshake(tvb)
  local size = tvb:len()
  if size < 6 or size > LARGEST or tvb:reported_len() > size then return false end
  local kind = tvb:range(0, 2):le_uint() / 4
  if kind ~= JOIN and kind ~= WELCOME and kind ~= REFUSAL then return false end
  return is_of(tvb:raw(), NO_EPOCH, kind == JOIN and UP or DOWN)
end

local function heuristic(tvb, pinfo, root)
  if not is_handshake(tvb) then return false end
  dissect(tvb, pinfo, root)
  pinfo.conversation = tactus -- all later datagrams of these two ends
  return true
end
tactus:register_heuristic("udp", heuristic)

-- Sealed sessions (70, section 11): inside the records of DTLS, if Wireshark has their secrets (SSLKEYLOGFILE).
local function inside_dtls(tvb, pinfo, root)
  local conversation = conversation_of(pinfo)
  if not is_handshake(tvb) and not (conversation.sealed and #conversation.epochs > 0) then return false end
  conversation.sealed = true
  dissect(tvb, pinfo, root)
  return true
end
tactus:register_heuristic("dtls", inside_dtls)

-- At the port of servers both come. Only in a session that is not sealed can a datagram look like a record of DTLS 1.2.
local dtls = Dissector.get("dtls")
function tactus.dissector(tvb, pinfo, root)
  local conversation = conversation_of(pinfo)
  local looks = tvb:len() > 13 and tvb:range(0, 1):uint() >= 20 and tvb:range(0, 1):uint() <= 25 and tvb:range(1, 1):uint() == 0xfe
  if looks and (conversation.sealed or #conversation.epochs == 0) then return dtls:call(tvb, pinfo, root) end
  return dissect(tvb, pinfo, root)
end

local ports, port = DissectorTable.get("udp.port"), tactus.prefs.port
ports:add(port, tactus)
function tactus.prefs_changed()
  if port ~= tactus.prefs.port then
    ports:remove(port, tactus)
    port = tactus.prefs.port
    ports:add(port, tactus)
  end
end
