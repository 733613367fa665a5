"""Compare plans of one program side by side, by workingstep.

Plans are what `optimise --json` prints, of other modes, machines, materials, tools or margins:

  optimise part.stpnc --mode TC --json --dry-run > TC.json
  optimise part.stpnc --mode QC --json --dry-run > QC.json
  stepnc compare TC.json QC.json -o compared.html

The others are told apart from the first plan. Totals are those of the workingsteps that every
plan times, so that no plan is fast because it leaves something out.
"""
