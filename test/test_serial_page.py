"""docs/serial.md says what the code reads, counts and measures."""

from __future__ import annotations

import re
import struct

from quotes import page, quoted, results, table, told
from wsn_tracking import bridging
from wsn_tracking.zstack import intake, lines, parser
from wsn_tracking.zstack.counters import new_counters
from wsn_tracking.zstack.payload import HEADER, crc16, decode_payload
from wsn_tracking.zstack.records import FORMATS

PAGE = page('serial')
LETTERS = {'uint8_t': 'B', 'int8_t': 'b', 'uint16_t': 'H', 'int16_t': 'h', 'uint32_t': 'I'}
RECORDS = {1: 'rssi_record', 3: 'range_record', 4: 'rssi_record', 5: 'feedback_record', 6: 'command_record'}


def structs():
    """Layout of each packed little-endian C struct of the page."""
    code = re.sub(r'/\*.*?\*/', '', re.search(r'```c\n(.*?)```', PAGE, re.DOTALL)[1], flags=re.DOTALL)
    found = {}
    for name, body in re.findall(r'struct (\w+) \{(.*?)\};', code, re.DOTALL):
        fields = [line.split(maxsplit=1) for line in body.split(';') if line.strip()]
        found[name] = '<' + ''.join(LETTERS[kind] * len(names.split(',')) for kind, names in fields)
    return found


def test_c_structs_are_what_is_read():
    found = structs()
    assert found.pop('header') == HEADER.format
    for kind, name in RECORDS.items():
        assert found[name] == FORMATS[kind].format
    assert found.keys() == set(RECORDS.values())


def test_payload_written_by_the_structs_is_understood():
    body = struct.pack(structs()['header'], 0x11, 1, 3, 700, 90_000, 1, 150)
    body += struct.pack(structs()['rssi_record'], 1, 7, -60, 5, 8, 9)
    payload = decode_payload(body + struct.pack('<H', crc16(body)))
    assert (payload.node_id, payload.seq, payload.t_ms, payload.battery_mv) == (3, 700, 90_000, 3000)
    assert payload.records == ((1, 7, -60, 5, 0.5, 9),)


def test_every_counter_of_the_link_is_explained():
    counters = {*new_counters(), *parser.COUNTERS, *lines.LineReader().counters, *intake.COUNTERS, *bridging.COUNTERS}
    table = PAGE[PAGE.index('| counter |') :].split('\n\n')[0]
    explained = re.findall(r'`(\w+)`', ' '.join(row.split('|')[1] for row in table.splitlines()[2:]))
    assert len(explained) == len(set(explained))
    assert set(explained) == counters


def test_figures_are_those_of_the_study():
    studies = results('serial')['studies']
    run, noise = studies['end_to_end'], studies['noise']
    latency, used = run['byte_to_measurement_ms'], set(run['measurements_used'].values())
    assert (run['faults'], len(used)) == ({}, 1)
    told = [
        (run['said'], run['arrived'], run['lost']),
        tuple(used),
        (latency['median'], latency['95_percent'], latency['longest']),
        (run['bridge_share_of_a_core'],),
        (run['fused_from_fewer_than_3'],),
        (noise['frames_by_chance'], noise['most_held_bytes']),
    ]
    table = PAGE[PAGE.index('## What it costs') :].split('|---|---|\n')[1].split('\n\n')[0]
    quoted = [re.findall(r'[\d.]+', row.split('|')[2]) for row in table.splitlines()]
    assert [tuple(map(float, row)) for row in quoted] == told
    assert latency['median'] < 5.0
    assert run['bridge_share_of_a_core'] < 0.2


def test_what_whole_decibels_cost_is_quoted():
    found = results('whole_db')['studies']['whole_db']
    rounded = {
        'no': 'exact',
        'behind it (on board)': 'behind',
        'before the trigger (on the host)': 'before',
        'yes': 'before',
    }
    assert found['runs'] == int(told('three scenarios of system A (@ runs', PAGE)[0])
    grown = []
    for scenario, trigger, how, share, sent, *errors in table(PAGE, 'scenario | trigger | rounded'):
        kept = found[scenario.strip('`')][trigger.strip('`')][rounded[how]]
        quoted((share, kept['sent_of_in_radius']['value']), (sent, kept['sent_a_run']['value']))
        for text, name in zip(errors, ('ei_cm_document', 'ei_cm_iplf'), strict=True):
            value, half = text.split(' ± ')
            low, high = kept[name]['interval_95']
            quoted((value, kept[name]['value']), (half, 0.5 * (high - low)))
        if how != 'no':
            grown += [kept[f'{name}_of_exact']['value'] for name in ('document', 'iplf')]
    (most, least) = told(
        "**The error grows by up to @ percent**, but on `a_heading` behind a host's trigger, where it shrinks by @.",
        PAGE,
    )
    quoted((most, 100 * (max(grown) - 1)), (least, 100 * (1 - min(grown))))
    assert sum(ratio < 1.0 for ratio in grown) == 2
