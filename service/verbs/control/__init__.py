r"""Run a program under closed-loop control of the cutting force.

examples:
  stepnc control part.stpnc --machine vmc15 --material c45 --preview
  stepnc control part.stpnc --machine vmc15 --disturb depth:+50%@12s --disturb kc:1.2
  stepnc control part.stpnc --machine vmc15 --law mpc --sensor power -o run.parquet \
      --report run.html

Run a program on the virtual machine while a control loop measures the cutting force and sets
the feed override: TC as fast as force and chip load allow, QC at the programmed feed or slower
if the force requires it.

disturbances, unknown to the loop:
  from a time on        depth:+50%@12s hardness:+30%@12s material:NAME@12s tooth:1@12s
                        silence:2s@12s line:off@12s override:80%@12s
  from the start        kc:1.3 wear:0.05mm/min runout:20um lag:60ms noise:3% drift:1N/s
                        missing:5% readings:20ms jitter:10%
  orders of an operator power:-50%@12s mode:QC@12s control:off@12s

--law none only monitors: the feed stays as programmed, and load, wear and events are told.

Exit code 5: the loop stopped the program (a broken tooth, a worn tool, too many feed holds),
the machine no longer answered or did not follow the override, the force stayed above its set
point, or the loop asks for a tool change.
"""
